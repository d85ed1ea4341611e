// The doctor on machines with missing parts: each is named.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/app/program.h"
#include "tests/support/folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;
using program::ReadText;
using program::Result;
using program::RunProgram;
using program::Surroundings;
using program::WriteText;
using ::testing::HasSubstr;
using ::testing::Not;

nlohmann::json CheckOf(const Result& result, const std::string& name) {
  const nlohmann::json document = result.Json();
  for (const auto& check : document["checks"]) {
    if (check["name"] == name) return check;
  }
  return {{"ok", nullptr}, {"found", ""}, {"advice", ""}};
}

TEST(Doctor, ReportsProgramsBlasThreadsAndCache) {
  const ScratchFolder folder;
  Surroundings surroundings;
  surroundings.before_start = [] { setenv("OMP_NUM_THREADS", "7", 1); };
  const Result result = RunProgram(folder, {"doctor", "--json"}, surroundings);
  EXPECT_TRUE(CheckOf(result, "mocurate-annotate")["ok"]) << result.out;
  EXPECT_TRUE(CheckOf(result, "mocurate-learn")["ok"]) << result.out;
  EXPECT_THAT(CheckOf(result, "BLAS")["found"].get<std::string>(), HasSubstr("GF/s on one thread"));
  EXPECT_THAT(CheckOf(result, "threads")["found"].get<std::string>(), HasSubstr("OMP_NUM_THREADS=7"));
  EXPECT_THAT(CheckOf(result, "cache")["found"].get<std::string>(), HasSubstr((folder / "cache").native()));
  EXPECT_EQ(result.exit_code, result.Json()["ok"].get<bool>() ? 0 : 4);
}

TEST(Doctor, BlasHasTheKernelsThatTheCpuCanRunUnlessTheUserNamesOthers) {
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return;  // the oldest kernels are right here
#endif
  const ScratchFolder folder;
  Surroundings surroundings;
  surroundings.before_start = [] { unsetenv("OPENBLAS_CORETYPE"); };
  const std::string chosen =
      CheckOf(RunProgram(folder, {"doctor", "--json"}, surroundings), "BLAS")["found"].get<std::string>();
  if (chosen.find("kernels") == std::string::npos) return;  // a BLAS that does not report them
  EXPECT_THAT(chosen, Not(HasSubstr("Prescott")));
  surroundings.before_start = [] { setenv("OPENBLAS_CORETYPE", "Nehalem", 1); };
  EXPECT_THAT(CheckOf(RunProgram(folder, {"doctor", "--json"}, surroundings), "BLAS")["found"].get<std::string>(),
              HasSubstr("kernels Nehalem"));
}

TEST(Doctor, TheReferenceBlasIsNamedWithItsFix) {
  const fs::path reference = fs::path("/usr/lib") / MOCURATE_MULTIARCH / "blas";
  if (!fs::exists(reference / "libblas.so.3")) {
    GTEST_SKIP() << "the reference BLAS is not here, so nothing can load it: scripts/install.sh tests";
  }
  const ScratchFolder folder;
  Surroundings surroundings;
  surroundings.before_start = [reference] { setenv("LD_LIBRARY_PATH", reference.c_str(), 1); };
  const Result result = RunProgram(folder, {"doctor", "--json"}, surroundings);
  EXPECT_EQ(result.exit_code, 4) << result.out;
  const nlohmann::json blas = CheckOf(result, "BLAS");
  EXPECT_FALSE(blas["ok"]);
  EXPECT_THAT(blas["found"].get<std::string>(), HasSubstr("the reference BLAS"));
  EXPECT_THAT(blas["advice"].get<std::string>(), HasSubstr("apt-get install libopenblas0-pthread"));
  EXPECT_THAT(blas["advice"].get<std::string>(), HasSubstr("update-alternatives --auto libblas.so.3-"));
}

/// mocurate installed below the folder of the test, its workers in libexec.
class Installed {
 public:
  explicit Installed(const ScratchFolder& folder) : workers_(folder / "prefix/libexec/mocurate") {
    fs::create_directories(workers_);
    fs::create_directories(folder / "prefix/bin");
    surroundings_.program = folder / "prefix/bin/mocurate";
    fs::copy_file(fs::path(kBinaryFolder) / "mocurate", surroundings_.program);
    for (const char* worker : {"mocurate-annotate", "mocurate-video", "mocurate-learn"}) {
      fs::copy_file(fs::path(kBinaryFolder) / worker, workers_ / worker);
    }
  }
  fs::path Worker(const std::string& name) const { return workers_ / name; }
  const Surroundings& surroundings() const { return surroundings_; }

 private:
  fs::path workers_;
  Surroundings surroundings_;
};

/// Makes a program need a library that does not exist.
void Rename(const fs::path& program, const std::string& library, const std::string& other) {
  std::string bytes = ReadText(program);
  const std::size_t at = bytes.find(library);
  ASSERT_NE(at, std::string::npos) << library;
  ASSERT_EQ(library.size(), other.size());
  bytes.replace(at, other.size(), other);
  WriteText(program, bytes);
}

TEST(Doctor, NamesALibraryThatAWorkerLacks) {
  const ScratchFolder folder;
  const Installed installed(folder);
  EXPECT_TRUE(CheckOf(RunProgram(folder, {"doctor", "--json"}, installed.surroundings()), "mocurate-learn")["ok"]);
  Rename(installed.Worker("mocurate-learn"), "libtorch_cpu.so.1.13", "libtorch_cpu.so.9.99");
  Rename(installed.Worker("mocurate-annotate"), "libyaml-cpp.so.0.7", "libyaml-cpp.so.9.9");
  const Result result = RunProgram(folder, {"doctor", "--json"}, installed.surroundings());
  EXPECT_EQ(result.exit_code, 4) << result.out;
  EXPECT_FALSE(result.Json()["ok"]);
  for (const auto& [library, worker] :
       {std::pair("libtorch_cpu.so.9.99", "mocurate-learn"), std::pair("libyaml-cpp.so.9.9", "mocurate-annotate")}) {
    const nlohmann::json check = CheckOf(result, worker);
    EXPECT_EQ(check["ok"], false) << worker << result.out;
    EXPECT_THAT(check["found"].get<std::string>(), HasSubstr(library));
  }

  const Result run = RunProgram(folder, program::SmallJob(folder, "r"), installed.surroundings());
  EXPECT_EQ(run.exit_code, 4) << run.err;
  EXPECT_THAT(run.err, HasSubstr("worker program 'mocurate-annotate' does not start"));
  EXPECT_THAT(run.err, HasSubstr("mocurate doctor"));
}

TEST(Doctor, AWorkerThatIsMissingBrokenOrOfAnotherVersionIsExitCode4) {
  const ScratchFolder folder;
  const Installed installed(folder);
  const fs::path learn = installed.Worker("mocurate-learn");
  const auto found = [&](const std::string& script) {
    WriteText(learn, script);
    chmod(learn.c_str(), 0755);
    const Result result = RunProgram(folder, {"doctor", "--json"}, installed.surroundings());
    EXPECT_EQ(result.exit_code, 4) << result.out;
    EXPECT_FALSE(CheckOf(result, "mocurate-learn")["ok"]);
    return CheckOf(result, "mocurate-learn")["found"].get<std::string>();
  };
  EXPECT_THAT(found("#!/bin/sh\necho no room for me >&2\nexit 3\n"), HasSubstr("does not start: no room for me"));
  EXPECT_THAT(found("#!/bin/sh\necho mocurate 0.0.0\n"), HasSubstr("is mocurate 0.0.0, this program is mocurate"));
  fs::remove(learn);
  const Result gone = RunProgram(folder, {"doctor", "--json"}, installed.surroundings());
  EXPECT_EQ(gone.exit_code, 4);
  EXPECT_THAT(CheckOf(gone, "mocurate-learn")["found"].get<std::string>(), HasSubstr("not found beside mocurate"));
}

}  // namespace
}  // namespace mocurate
