#include "fitting/rules.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/config.h"
#include "fitting/clouds/cloud_terms.h"
#include "fitting/clouds/cloud_uncertainty.h"
#include "fitting/options.h"
#include "fitting/solver/joint_track_fit.h"
#include "tests/fitting/takes.h"

namespace mocurate {
namespace {

Rules Without(FittingRule rule) {
  Rules rules;
  rules.SwitchOff(rule);
  return rules;
}

/// Noise of 20 mm, a wrist that is not observed for a second, a joint that is never observed, and one sample 1 m off.
SkeletonTracks FaultyTracks() {
  SkeletonTracks tracks = SmoothTake(75).tracks;
  AddNoise(tracks, 0.02, 5);
  tracks.positions.at(10, *tracks.skeleton->FindJoint("right_wrist")) += Vector3d(0.0, 1.0, 0.0);
  for (int f = 20; f < 50; ++f) Hide(tracks, f, *tracks.skeleton->FindJoint("left_wrist"));
  for (int f = 0; f < tracks.frames(); ++f) Hide(tracks, f, *tracks.skeleton->FindJoint("head_top"));
  return tracks;
}

FitResult FitWith(const Rules& rules) {
  const SkeletonTracks tracks = FaultyTracks();
  JointTrackOptions options;
  options.solver = PoseSolver::kBanded;
  options.rules = rules;
  auto fit = FitJointTracks(tracks, FrameRate::FromHz(30.0), tracks.skeleton->RestBoneLengths(), options);
  EXPECT_TRUE(fit.has_value()) << fit.error().Message();
  return fit ? std::move(*fit) : FitResult{};
}

TEST(FittingRules, EachHasOneName) {
  const std::vector<std::string>& names = FittingRuleNames();
  EXPECT_EQ(names.size(), static_cast<std::size_t>(FittingRule::kCount));
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  EXPECT_EQ(names[static_cast<std::size_t>(FittingRule::kGapInflation)], "gap_inflation");
  EXPECT_EQ(names[static_cast<std::size_t>(FittingRule::kRayNoise)], "ray_noise");
  EXPECT_EQ(names.back(), "inconsistent_views");
}

TEST(FittingRules, AnUnknownNameIsRefusedWithTheKnownOnes) {
  const auto from_json = OptionsFromJson<FittingOptions>(
      {{"without", nlohmann::json::array({"low_coverage", "gap_inflaton"})}}, "fitting");
  ASSERT_FALSE(from_json);
  EXPECT_NE(from_json.error().Message().find("without.1"), std::string::npos) << from_json.error().Message();
  EXPECT_NE(from_json.error().Message().find("'gap_inflation'"), std::string::npos) << from_json.error().Message();

  const auto node = LoadConfig(ConfigSource{"without: [low_coverage, gap_inflaton]\n", "c.yaml", "folder"}, {});
  ASSERT_TRUE(node) << node.error().Message();
  const auto from_yaml = OptionsFromConfig<FittingOptions>(*node);
  ASSERT_FALSE(from_yaml);
  for (const std::string& name : FittingRuleNames())
    EXPECT_NE(from_yaml.error().Message().find(name), std::string::npos) << name;
}

TEST(FittingRules, ANameReachesEveryGroup) {
  const auto options =
      OptionsFromJson<FittingOptions>({{"without", nlohmann::json::array({"far_move", "gap_inflation"})}}, "fitting");
  ASSERT_TRUE(options) << options.error().Message();
  for (const Rules* rules :
       {&options->rules, &options->repair.rules, &options->joint_tracks.rules, &options->point_clouds.rules,
        &options->point_clouds.audit.rules, &options->keypoints.audit.rules}) {
    EXPECT_FALSE(rules->on(FittingRule::kFarMove));
    EXPECT_FALSE(rules->on(FittingRule::kGapInflation));
    EXPECT_TRUE(rules->on(FittingRule::kBoneNoise));
  }
  EXPECT_EQ(OptionsToJson(*options)["without"], nlohmann::json::array({"gap_inflation", "far_move"}));
  const auto proportions =
      OptionsFromJson<ProportionsOptions>({{"without", nlohmann::json::array({"far_move"})}}, "proportions");
  ASSERT_TRUE(proportions) << proportions.error().Message();
  EXPECT_FALSE(proportions->point_clouds.audit.rules.on(FittingRule::kFarMove));
}

TEST(FittingRules, AllAreOnByDefault) {
  for (int i = 0; i < static_cast<int>(FittingRule::kCount); ++i)
    EXPECT_TRUE(FittingOptions{}.joint_tracks.rules.on(static_cast<FittingRule>(i))) << FittingRuleNames()[i];
  const auto read = OptionsFromJson<FittingOptions>({{"without", nlohmann::json::array()}}, "fitting");
  ASSERT_TRUE(read) << read.error().Message();
  const FitResult by_default = FitWith({});
  const FitResult as_read = FitWith(read->joint_tracks.rules);
  EXPECT_EQ(by_default.motion.joints.xyz, as_read.motion.joints.xyz);
  EXPECT_EQ(by_default.motion.position_cov, as_read.motion.position_cov);
  EXPECT_EQ(by_default.motion.rotation_sigma, as_read.motion.rotation_sigma);
}

TEST(FittingRules, WithoutARuleOfUncertaintyOnlyTheStatedCovarianceChanges) {
  const FitResult all = FitWith({});
  for (const FittingRule rule :
       {FittingRule::kUncertaintyCalibration, FittingRule::kGapInflation, FittingRule::kBodyErrors}) {
    const FitResult without = FitWith(Without(rule));
    EXPECT_EQ(without.motion.joints.xyz, all.motion.joints.xyz) << FittingRuleNames()[static_cast<std::size_t>(rule)];
    EXPECT_NE(without.motion.position_cov, all.motion.position_cov)
        << FittingRuleNames()[static_cast<std::size_t>(rule)];
  }
}

TEST(FittingRules, GapInflationWidensTheGapAlone) {
  const FitResult all = FitWith({}), without = FitWith(Without(FittingRule::kGapInflation));
  const auto variance = [](const Motion& motion, int frame) {
    const int wrist = *motion.skeleton->FindJoint("left_wrist");
    return motion.position_cov[6 * (static_cast<std::size_t>(frame) * motion.joint_count() + wrist)];
  };
  EXPECT_GT(variance(all.motion, 35), 2.0F * variance(without.motion, 35));
  EXPECT_EQ(variance(all.motion, 5), variance(without.motion, 5));
}

TEST(FittingRules, WithoutOutlierRejectionNoSampleIsRejected) {
  const auto rejected = [](const FitResult& fit) {
    return std::any_of(fit.findings.begin(), fit.findings.end(),
                       [](const Finding& finding) { return finding.code == kOutliersRejected; });
  };
  const FitResult all = FitWith({}), without = FitWith(Without(FittingRule::kOutlierRejection));
  EXPECT_TRUE(rejected(all));
  EXPECT_FALSE(rejected(without));
  EXPECT_NE(without.motion.joints.xyz, all.motion.joints.xyz);
}

TEST(FittingRules, RulesOfDepthFitsAreNeutralWhenOff) {
  FusedCloud flat;  // one side of a small part of a person
  flat.points = Eigen::Matrix3Xd::Random(3, 50);
  flat.normals = Vector3d::UnitZ().replicate(1, 50);
  PointCloudOptions options;
  EXPECT_GT(LowCoverageSigma(flat, options, 1.0), kUnobservedError);
  EXPECT_GT(BodyErrorFactor(0.02, options.rules), 1.0);
  EXPECT_LT(PatchShare(flat, options), 1.0);
  const double unknown_shape = DeviationsInClouds(*TestSkeleton(), 1.0, 1.0, options.rules).capsule_end;
  EXPECT_GT(unknown_shape, 0.0);
  for (const FittingRule rule :
       {FittingRule::kLowCoverage, FittingRule::kBodyErrorFactor, FittingRule::kPatchShare, FittingRule::kUnknownShape})
    options.rules.SwitchOff(rule);
  EXPECT_EQ(LowCoverageSigma(flat, options, 1.0), 0.0);
  EXPECT_EQ(BodyErrorFactor(0.02, options.rules), 1.0);
  EXPECT_EQ(PatchShare(flat, options), 1.0);
  EXPECT_NEAR(unknown_shape / DeviationsInClouds(*TestSkeleton(), 1.0, 1.0, options.rules).capsule_end, 3.0, 1e-9);
  options.rules.SwitchOff(FittingRule::kBodyErrors);
  EXPECT_EQ(DeviationsInClouds(*TestSkeleton(), 1.0, 1.0, options.rules).capsule_end, 0.0);
}

}  // namespace
}  // namespace mocurate
