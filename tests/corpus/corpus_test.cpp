// A short fuzz run without libFuzzer: the functions of tests/fuzz read their seeds, the regression inputs
// (tests/fuzz/regressions) and damaged copies of both. Every run uses the same inputs.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>

#include "core/base/file.h"
#include "tests/fuzz/seeds.h"
#include "tests/support/child.h"
#include "tests/support/folders.h"
#include "tests/support/mutation.h"

#define MOCURATE_FUZZ_TARGET(name) extern "C" int mocurate_fuzz_##name(const std::uint8_t* data, std::size_t size);
#include "fuzz_targets.inc"
#undef MOCURATE_FUZZ_TARGET

namespace mocurate {
namespace {

struct Target {
  const char* name;
  int (*run)(const std::uint8_t* data, std::size_t size);
};

constexpr Target kTargets[] = {
#define MOCURATE_FUZZ_TARGET(name) {#name, mocurate_fuzz_##name},
#include "fuzz_targets.inc"
#undef MOCURATE_FUZZ_TARGET
};

constexpr int kDamagedCopies = 400;   // per target
constexpr unsigned kLongest_s = 120;  // per target; typically 1 s, with sanitizers 10 s
#ifdef __SANITIZE_ADDRESS__
constexpr long kMostMemory_kb = 1024 * 1024;  // the sanitizer delays freeing memory
#else
constexpr long kMostMemory_kb = 512 * 1024;
#endif

struct Input {
  std::string name;
  std::string bytes;
};

std::vector<Input> InputsOf(const std::string& target) {
  static const FuzzSeeds seeds = AllFuzzSeeds();
  std::vector<Input> inputs;
  for (const FuzzSeed& seed : seeds) {
    if (seed.target == target) inputs.push_back({"seed " + std::to_string(inputs.size()), seed.bytes});
  }
  const std::filesystem::path known = std::filesystem::path(kSourceFolder) / "tests/fuzz/regressions" / target;
  if (std::filesystem::exists(known)) {
    std::vector<std::filesystem::path> files(std::filesystem::directory_iterator(known), {});
    std::sort(files.begin(), files.end());
    for (const auto& file : files) inputs.push_back({file.filename().string(), ReadFile(file).value()});
  }
  const std::size_t whole = inputs.size();
  Random random(11, "corpus", target);
  for (int i = 0; whole > 0 && i < kDamagedCopies; ++i) {
    const Input& input = inputs[static_cast<std::size_t>(i) % whole];
    inputs.push_back({input.name + ", damaged copy " + std::to_string(i), test::Mutated(input.bytes, random)});
  }
  return inputs;
}

class Corpus : public ::testing::TestWithParam<Target> {};

TEST_P(Corpus, IsReadWithoutCrashHangOrExcessiveMemory) {
  const std::vector<Input> inputs = InputsOf(GetParam().name);
  ASSERT_GT(inputs.size(), static_cast<std::size_t>(kDamagedCopies)) << "no seed in tests/fuzz/seeds_*.cpp";
  const test::Children children = test::InChildren(inputs.size(), kLongest_s, [&](std::size_t i) {
    GetParam().run(reinterpret_cast<const std::uint8_t*>(inputs[i].bytes.data()), inputs[i].bytes.size());
  });
  for (const test::Children::Death& death : children.deaths) {
    ADD_FAILURE() << inputs[death.index].name << ": " << ::strsignal(death.signal);
  }
  EXPECT_LT(children.most_memory_kb, kMostMemory_kb);
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Corpus, ::testing::ValuesIn(kTargets),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace mocurate
