#include <gtest/gtest.h>

#include "fitting/proportions.h"
#include "fitting/solver/joint_track_fit.h"
#include "tests/fitting/track_problems.h"

namespace mocurate {
namespace {

/// 30 mm RMS noise, 2 % gross outliers, bones 6 % off the rest bones; two of the files also lack 5 % of the joints.
class PlatformProblem : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (ReferenceFolder().empty()) GTEST_SKIP() << "no reference problems: set MOCURATE_REFERENCE to their folder";
  }
};

INSTANTIATE_TEST_SUITE_P(Reference, PlatformProblem,
                         testing::Values("platform_seed0", "platform_seed1", "platform_seed2",
                                         "platform_dropouts5_seed0", "platform_dropouts5_seed1"));

TEST_P(PlatformProblem, IsSolvedWithinFifteenMillimetresAndNearTheOptimum) {
  const ReferenceProblem problem = ReadReferenceProblem(ReferenceFolder() / (std::string(GetParam()) + ".h5"));
  ProportionsOptions medians;
  medians.symmetric = false;
  const auto person = EstimateProportions({problem.tracks}, problem.tracks.skeleton, medians);
  JointTrackOptions options;
  const auto fit = FitJointTracks(problem.tracks, problem.rate, person.bone_length, options);
  ASSERT_TRUE(fit.has_value()) << fit.error().Message();
  EXPECT_LT(RmsError(fit->motion.joints, problem.truth), 0.015);
  EXPECT_NEAR(fit->noise_sigma, 0.0173, 0.002);  // 30 mm RMS in 3-D

  options.steps = StepsWithRefits(0);  // the same problem, solved loosely and tightly
  const auto loose = FitJointTracks(problem.tracks, problem.rate, person.bone_length, options);
  ASSERT_TRUE(loose.has_value());
  options.steps = {{FreeParts::kPose, StepEvidence::kAll, 1e-6, 200}};
  const auto tight = FitJointTracks(problem.tracks, problem.rate, person.bone_length, options);
  ASSERT_TRUE(tight.has_value());
  EXPECT_LT(loose->final_cost, 1.001 * tight->final_cost);
}

TEST_P(PlatformProblem, MediansEstimateItsBonesWithinAFewMillimetres) {
  const ReferenceProblem problem = ReadReferenceProblem(ReferenceFolder() / (std::string(GetParam()) + ".h5"));
  ProportionsOptions medians;
  medians.symmetric = false;
  const auto person = EstimateProportions({problem.tracks}, problem.tracks.skeleton, medians);
  double sum = 0.0;
  double bias = 0.0;
  for (std::size_t j = 1; j < problem.bone_length.size(); ++j) {
    sum += std::abs(person.bone_length[j] - problem.bone_length[j]) / 23.0;
    bias += (person.bone_length[j] - problem.bone_length[j]) / 23.0;
  }
  EXPECT_LT(sum, 0.004);
  EXPECT_LT(std::abs(bias), 0.002);  // the estimate subtracts the lengthening by noise
}

}  // namespace
}  // namespace mocurate
