#include <dlfcn.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "core/base/file.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/pipeline/runner.h"
#include "job/blas_kernels.h"
#include "job/verbs/verbs.h"
#include "job/verbs/worker_check.h"

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

/// A worker program, then one line per missing shared library.
std::vector<Check> CheckWorker(const std::string& name, const std::string& does) {
  std::error_code ignored;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const std::filesystem::path& folder : {self, self.parent_path() / "libexec" / "mocurate"}) {
    const std::filesystem::path program = folder / name;
    if (access(program.c_str(), X_OK) != 0) continue;
    const WorkerCheck worker = CheckWorkerProgram(program);
    Check check{name, worker.starts, DisplayPath(program), ""};
    if (worker.starts && worker.version != CreatedBy()) {
      check.ok = false;
      check.found += " is " + worker.version + ", this program is " + std::string(CreatedBy());
      check.advice = "build and install both programs together";
    } else if (!worker.starts) {
      check.found += " does not start: " + worker.last_output_line;
      check.advice = does + " needs it; " +
                     (worker.missing.empty() ? "build it again; scripts/install.sh installs its libraries"
                                             : "install the libraries below");
    }
    std::vector<Check> checks = {check};
    for (const MissingLibrary& library : worker.missing) {
      const std::string package = library.package.empty() ? "the package that contains it" : library.package;
      checks.push_back({library.name, false, "not found; " + name + " needs it", "apt-get install " + package});
    }
    return checks;
  }
  return {{name, false, "not found beside mocurate",
           does + " needs it: build the slice that contains it (MOCURATE_SLICE=all)"}};
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

}  // namespace

Status DoctorVerb(CommonArguments& common) {
  ChooseBlasKernels();
  const Check threads = CheckThreads();  // before the check of the BLAS sets its threads
  std::vector<Check> checks = {{"version", true, std::string(CreatedBy()), ""}};
  for (const auto& [name, does] : {std::pair<const char*, const char*>{"mocurate-annotate", "ingesting and fitting"},
                                   {"mocurate-video", "inspecting video files"},
                                   {"mocurate-learn", "training and evaluating"}}) {
    const std::vector<Check> worker = CheckWorker(name, does);
    checks.insert(checks.end(), worker.begin(), worker.end());
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
  if (common.json) PrintJson(document);
  common.answered = common.json;
  if (missing == 0) return {};
  return Fail(ErrorCode::kMissingOnHost, Counted(missing, "check") + " failed", "doctor",
              "each line lists what to install or set");
}

}  // namespace mocurate
