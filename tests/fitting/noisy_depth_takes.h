#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "fitting/clouds/cloud_rig_audit.h"
#include "tests/fitting/cloud_takes.h"

namespace mocurate {

/// Takes of 12 frames, with a Kinect's errors; skipped without MOCURATE_DATA's body.
template <std::uint64_t seed, int clips>
class NoisyDepthTakes : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    CloudTakeOptions options;
    options.seed = seed;
    options.subjects = 1;
    options.clips = clips;
    options.frames = 12;
    const std::string name = "mocurate_depth_takes_" + std::to_string(getpid()) + "_" + std::to_string(seed);
    takes_ = new std::vector<CloudTake>(CloudTakes(options, std::filesystem::path(testing::TempDir()) / name));
  }

  void SetUp() override {
    if (takes_->empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }

  static const std::vector<CloudTake>& takes() { return *takes_; }

 private:
  static inline std::vector<CloudTake>* takes_ = nullptr;
};

/// What an audit told, a line each.
inline std::string Told(const DepthRigReport& report) {
  std::string text;
  for (const RigFault& fault : report.faults) text += fault.code + " " + fault.message + "\n";
  return text + report.not_audited;
}

}  // namespace mocurate
