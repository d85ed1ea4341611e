#pragma once

#include <gtest/gtest.h>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "fitting/clouds/cloud_rig_audit.h"
#include "tests/fitting/cloud_takes.h"
#include "tests/support/scratch_folder.h"

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
    takes_ = new std::vector<CloudTake>(CloudTakes(options, SharedScratch("depth_takes_" + std::to_string(seed))));
  }

  void SetUp() override {
    if (takes_->empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }

  static const std::vector<CloudTake>& takes() { return *takes_; }

 private:
  static inline std::vector<CloudTake>* takes_ = nullptr;
};

/// Faults of an audit, one per line, then why it was not audited.
inline std::string FaultLines(const DepthRigReport& report) {
  std::string text;
  for (const RigFault& fault : report.faults) text += fault.code + " " + fault.message + "\n";
  return text + report.not_audited;
}

}  // namespace mocurate
