#include <dlfcn.h>
#include <sys/statvfs.h>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/pipeline/stage_run.h"
#include "ingest/expected_files.h"
#include "job/job_options.h"
#include "job/machine.h"
#include "job/named_configs.h"
#include "job/run_and_capture.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

constexpr double kSlowBlas = 10.0;  // GF/s of one thread; reference BLAS reaches 6 to 7, OpenBLAS more than 100,
                                    // and 15 beside other programs that use all cores

struct Check {
  std::string name;
  bool ok = true;
  std::string found;
  std::string advice;
};

/// The BLAS used by programs on this machine: the file behind libblas.so.3 and the speed of a 256x256 sgemm on one
/// thread.
Check CheckBlas() {
  Check check{"BLAS", false, "libblas.so.3 cannot be loaded", "apt-get install libopenblas0-pthread"};
  setenv("OPENBLAS_NUM_THREADS", "1", 0);
  void* library = dlopen("libblas.so.3", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return check;
  using Sgemm = void (*)(const char*, const char*, const int*, const int*, const int*, const float*, const float*,
                         const int*, const float*, const int*, const float*, float*, const int*);
  const auto sgemm = reinterpret_cast<Sgemm>(dlsym(library, "sgemm_"));
  Dl_info info{};
  if (sgemm == nullptr || dladdr(reinterpret_cast<void*>(sgemm), &info) == 0) return check;
  std::error_code ignored;
  const std::filesystem::path file = std::filesystem::canonical(info.dli_fname, ignored);

  constexpr int n = 256;
  constexpr std::size_t count = std::size_t{n} * n;
  std::vector<float> a(count, 1.0f);
  std::vector<float> b(count, 0.5f);
  std::vector<float> c(count, 0.0f);
  const float one = 1.0f;
  const float zero = 0.0f;
  const auto seconds_since = [](std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  double best = 1e9;
  for (const auto begin = std::chrono::steady_clock::now(); seconds_since(begin) < 0.1;) {
    const auto start = std::chrono::steady_clock::now();
    sgemm("N", "N", &n, &n, &n, &one, a.data(), &n, b.data(), &n, &zero, c.data(), &n);
    best = std::min(best, seconds_since(start));
  }
  const double gigaflops = 2.0 * n * n * n / best * 1e-9;
  check.ok = gigaflops >= kSlowBlas;
  char speed[64];
  std::snprintf(speed, sizeof(speed), ", %.0f GF/s on one thread", gigaflops);
  check.found = DisplayPath(file) + speed;
  const auto kernels = reinterpret_cast<const char* (*)()>(dlsym(library, "openblas_get_corename"));
  if (kernels != nullptr) check.found += std::string(", kernels ") + kernels();
  check.advice.clear();
  if (check.ok) return check;
  const bool reference = file.parent_path().filename() == "blas";  // path of Debian's libblas3
  if (reference) check.found += ": the reference BLAS";
  check.advice =
      "training is 4 to 15 times slower with this BLAS: apt-get install libopenblas0-pthread, then "
      "update-alternatives --auto libblas.so.3-" MOCURATE_MULTIARCH " (and unset LD_LIBRARY_PATH if it names another)";
  return check;
}

Check CheckWorker(const std::string& name, const std::string& does) {
  const auto program = FindWorkerProgram(RunnerOptions(), name);
  if (!program) {
    return {name, false, "not found beside mocurate",
            does + " needs it: build the slice that contains it (MOCURATE_SLICE=all)"};
  }
  const ProgramAnswer answer = RunAndCapture(*program, {"--version"});
  const std::string said = LastLine(answer.text);  // where a library is missing, the linker names it
  Check check{name, answer.exit_status == 0 && said == CreatedBy(), DisplayPath(*program), ""};
  if (answer.exit_status != 0) {
    check.found += " does not start: " + said;
    check.advice = does + " needs it: scripts/install.sh installs its libraries (docs/dependencies.md)";
  } else if (!check.ok) {
    check.found += " is " + said + ", this program is " + std::string(CreatedBy());
    check.advice = "build and install both programs together";
  }
  return check;
}

Check CheckThreads() {
  const char* blas = std::getenv("OPENBLAS_NUM_THREADS");
  const char* openmp = std::getenv("OMP_NUM_THREADS");
  Check check{"threads", true,
              std::to_string(std::thread::hardware_concurrency()) + " cores; OPENBLAS_NUM_THREADS=" +
                  (blas != nullptr ? blas : "unset") + ", OMP_NUM_THREADS=" + (openmp != nullptr ? openmp : "unset"),
              ""};
  check.advice = "mocurate gives each worker one BLAS and one OpenMP thread and runs clips in parallel (--jobs)";
  return check;
}

Check CheckCache() {
  const std::filesystem::path folder = DefaultCacheFolder();
  Check check{"cache", true, DisplayPath(folder), ""};
  if (Status made = MakeFolder(folder); !made) {
    check.ok = false;
    check.advice = made.error().Message() + "; set MOCURATE_CACHE to a writable folder";
    return check;
  }
  struct statvfs space {};
  if (statvfs(folder.c_str(), &space) == 0) {
    const double free_gb = static_cast<double>(space.f_bavail) * static_cast<double>(space.f_frsize) * 1e-9;
    char text[64];
    std::snprintf(text, sizeof(text), ", %.1f GB free", free_gb);
    check.found += text;
    check.ok = free_gb > 1.0;
    if (!check.ok) check.advice = "less than 1 GB is free: mocurate cache prune, or set MOCURATE_CACHE";
  }
  return check;
}

/// The ingest group of a source declaration. A folder whose environment variable is not set is no error here: the verb
/// reports it.
Expected<IngestOptions> LoadIngest(const std::string& name, const std::filesystem::path& path, const ConfigRules& rules,
                                   bool& placed) {
  const Expected<ConfigSource> source = SourceOf(name);
  if (!source) return Forward(source);
  std::vector<std::string> assignments;
  if (!path.empty()) assignments.push_back("ingest.path=" + path.string());
  Expected<ConfigNode> node = LoadConfig(*source, assignments, rules);
  placed = node.has_value();
  if (!node) node = LoadConfig(*source, {"ingest.path=."}, rules);
  if (!node) return Forward(node);
  const auto job = OptionsFromConfig<JobOptions>(*node);
  if (!job) return Forward(job);
  placed = placed && !job->ingest.path.empty();
  return job->ingest;
}

nlohmann::json Entry(const ExpectedFile& file) {
  nlohmann::json entry = {{"pattern", file.pattern}, {"what", file.what}, {"found", file.found}};
  if (file.found == 0 && file.found_elsewhere > 0)
    entry["elsewhere"] = {{"path", DisplayPath(file.elsewhere)}, {"found", file.found_elsewhere}};
  if (file.others > 0) entry["other_names"] = {{"files", file.others}, {"first", file.other}};
  return entry;
}

/// Folders with the searched files, and files with similar names.
std::string RemarkOfFile(const ExpectedFile& file) {
  std::string remark;
  if (file.found == 0 && file.found_elsewhere > 0) {
    remark = "; " + Counted(static_cast<long long>(file.found_elsewhere), "such file") + " below " +
             DisplayPath(file.elsewhere);
  } else if (file.others > 0) {
    remark = "; " + Counted(static_cast<long long>(file.others), "file") + " with this ending and another name, e.g. " +
             file.other;
  }
  return remark;
}

}  // namespace

Status DoctorVerb(CommonArguments& common) {
  ChooseBlasKernels();
  const Check threads = CheckThreads();  // before the check of the BLAS sets its threads
  std::vector<Check> checks = {{"version", true, std::string(CreatedBy()), ""}};
  for (const auto& [name, does] : {std::pair<const char*, const char*>{"mocurate-annotate", "ingesting and fitting"},
                                   {"mocurate-video", "inspecting video files"},
                                   {"mocurate-learn", "training and evaluating"}}) {
    checks.push_back(CheckWorker(name, does));
  }
  for (const Check& check : {CheckBlas(), threads, CheckCache()}) checks.push_back(check);
  nlohmann::json document = {{"checks", nlohmann::json::array()}};
  int missing = 0;
  for (const Check& check : checks) {
    missing += check.ok ? 0 : 1;
    document["checks"].push_back(
        {{"name", check.name}, {"ok", check.ok}, {"found", check.found}, {"advice", check.advice}});
    if (common.json) continue;
    Print("%-4s %-20s %s\n", check.ok ? "ok" : "BAD", check.name.c_str(), check.found.c_str());
    if (!check.advice.empty()) Print("     %-20s %s\n", "", check.advice.c_str());
  }
  document["ok"] = missing == 0;
  AnswersInText(common, document);
  if (missing == 0) return {};
  return Fail(ErrorCode::kMissingOnHost, Counted(missing, "check") + " failed", "doctor",
              "each line lists what to install or set");
}

Status DoctorSourceVerb(CommonArguments& common, const DoctorArguments& arguments) {
  bool placed = false;
  const Expected<IngestOptions> ingest = LoadIngest(arguments.source, arguments.path, {common.allow_include}, placed);
  if (!ingest) return Forward(ingest);
  if (Status sound = CheckSource(ingest->source); !sound) return sound;
  std::error_code unknown;
  const bool there = placed && std::filesystem::is_directory(ingest->path, unknown);
  const bool made = ingest->synthetic.enabled && !placed;
  const Expected<std::vector<ExpectedFile>> wanted = made ? std::vector<ExpectedFile>() : ExpectedFiles(*ingest, there);
  if (!wanted) return Forward(wanted);
  const std::string folder = placed ? DisplayPath(ingest->path) : "";
  nlohmann::json document = {{"source", ingest->source.name}, {"licence", ingest->source.licence},
                             {"obtain", ingest->obtain},      {"path", folder},
                             {"path_exists", there},          {"files", nlohmann::json::array()}};
  std::size_t missing = 0;
  std::filesystem::path elsewhere;
  for (const ExpectedFile& file : *wanted) {
    missing += file.found == 0 ? 1 : 0;
    if (file.found == 0 && elsewhere.empty()) elsewhere = file.elsewhere;
    document["files"].push_back(Entry(file));
  }
  document["ok"] = missing == 0;
  if (AnswersInText(common, document)) {
    Print("source   %s\nlicence  %s\n", ingest->source.name.c_str(),
          ingest->source.licence.empty() ? "not stated" : ingest->source.licence.c_str());
    if (!ingest->obtain.empty()) Print("obtain   %s\n", ingest->obtain.c_str());
    Print("folder   %s\n", made      ? "none: the program generates the files"
                           : !placed ? "unknown: set ingest.path, or use --path here"
                                     : (folder + (there ? "" : " (does not exist)")).c_str());
    for (const ExpectedFile& file : *wanted) {
      Print("%-8s %s: %s", file.found > 0 ? "ok" : "MISSING", file.pattern.c_str(), file.what.c_str());
      if (file.found > 0) Print(" (%zu files)", file.found);
      Print("%s\n", RemarkOfFile(file).c_str());
    }
  }
  if (missing == 0) return {};
  return Fail(ErrorCode::kMissingOnHost,
              std::to_string(missing) + " of " + std::to_string(wanted->size()) + " kinds of files are missing",
              arguments.source,
              !elsewhere.empty()
                  ? "files with these names are below " + DisplayPath(elsewhere) + ": name that folder (--path)"
              : placed ? "put them below " + folder + " under these names"
                       : "put them into a folder and give it as --path DIR");
}

}  // namespace mocurate
