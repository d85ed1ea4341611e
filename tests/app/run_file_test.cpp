// run.json records the program, options and machine of a run, including all that its bytes depend on.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/app/program.h"

namespace mocurate {
namespace {

using program::ReadText;
using program::Result;
using program::RunProgram;
using ::testing::HasSubstr;

TEST(RunFile, RecordsTheMachineAsFarAsBytesDependOnIt) {
  const ScratchFolder folder;
  std::vector<std::string> arguments = program::SmallJob(folder, "r");
  std::replace(arguments.begin(), arguments.end(), std::string("assemble"), std::string("ingest"));
  const Result result = RunProgram(folder, arguments);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const nlohmann::json machine = nlohmann::json::parse(ReadText(folder / "r/run.json"))["machine"];
  const std::string cpus = ReadText("/proc/cpuinfo");
  EXPECT_THAT(cpus, HasSubstr(machine["cpu"].get<std::string>()));
  for (const auto& set : machine["simd"]) {
    std::string flag = set.get<std::string>();
    if (flag == "sse4.2") flag = "sse4_2";
    if (flag == "neon") continue;
    EXPECT_THAT(cpus, HasSubstr(" " + flag)) << "claimed, but the system does not say so";
  }
  ASSERT_TRUE(machine.contains("blas"));
  if (machine["blas"].is_null()) GTEST_SKIP() << "this machine has no libblas.so.3";
  const std::string library = machine["blas"]["library"];
  EXPECT_TRUE(std::filesystem::exists(library)) << library;
  EXPECT_EQ(machine["blas"].contains("kernels"), library.find("openblas") != std::string::npos);
}

}  // namespace
}  // namespace mocurate
