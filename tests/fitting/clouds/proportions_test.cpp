// One body for a person whose clips have only depth views: unusable clips are skipped, the person is kept.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/store/store.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/clouds/fit_clouds.h"
#include "fitting/proportions.h"
#include "fitting/stages.h"
#include "tests/fitting/cloud_scene.h"
#include "tests/support/depth_files.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

constexpr double kTaller = 1.1;

/// A person a tenth taller than the rest skeleton, standing with arms held a little apart.
class DepthProportions : public ::testing::Test {
 protected:
  void SetUp() override {
    const Motion still = StandingStill(*LoadSkeleton("smpl24"), kTaller, FrameRate{12, 1}, 1);
    for (const char* name : {"r1", "r2", "r3"}) {
      Expected<Clip> clip = RenderClip(still, folder_ / name);
      ASSERT_TRUE(clip) << clip.error().Message();
      clip->identity.source = "studio";
      clip->identity.person = "p1";
      clip->identity.recording = name;
      clip->identity.end_frame = 1;
      clips_.push_back(std::move(*clip));
    }
  }
  /// The image of a clip's first camera is not a PNG.
  void Damage(const Clip& clip) const { std::ofstream(clip.evidence.depth_views[0].files[0]) << "not an image"; }

  StageRequest Request(const std::string& stage, const std::string& item, const std::vector<Clip>& clips) const {
    StageRequest request;
    request.stage = stage;
    request.item = item;
    request.options = {{"skeleton", "smpl24"}, {"method", "point_clouds"}};
    if (stage == "fitting") request.options["solver"] = "banded";
    for (Clip clip : clips) {
      for (DepthView& view : clip.evidence.depth_views) view.sha256 = {*Sha256OfFile(view.files[0])};
      const std::filesystem::path path = folder_ / (clip.identity.recording + ".h5");
      EXPECT_TRUE(WriteEvidence(clip, path));
      request.inputs.push_back({"evidence", clip.id(), path, std::string(64, 'a')});
    }
    request.output = folder_ / (stage + ".out");
    return request;
  }

  Expected<StageOutcome> Measure() const { return ProportionsStage(Request("proportions", "p1", clips_)); }

  ScratchFolder folder_;
  std::vector<Clip> clips_;
};

TEST_F(DepthProportions, UseTheReadableClipsAndReportTheOthers) {
  Damage(clips_[1]);
  for (DepthView& view : clips_[2].evidence.depth_views) view.camera.camera_from_world.translation *= 1000.0;
  const auto measured = Measure();
  ASSERT_TRUE(measured) << measured.error().Message();
  ASSERT_EQ(measured->findings.size(), 2u);
  for (const Finding& finding : measured->findings) {
    EXPECT_EQ(finding.code, "no_proportions_from_clip");
    EXPECT_EQ(finding.action, FindingAction::kExcluded);
  }
  EXPECT_EQ(measured->findings[0].clip, clips_[1].id());
  EXPECT_THAT(measured->findings[0].message, HasSubstr("c0_0.png"));
  EXPECT_EQ(measured->findings[1].clip, clips_[2].id());
  EXPECT_THAT(measured->findings[1].message, HasSubstr("1000 times too long"));
  const double scale = measured->summary["scale"];
  EXPECT_NEAR(scale, kTaller, 0.06);
  const double knee = measured->summary["bone_length_m"]["left_knee"];
  EXPECT_NEAR(knee / (*LoadSkeleton("smpl24"))->RestBoneLengths()[4], kTaller, 0.1);
  EXPECT_EQ(measured->summary["body_shape"].size(), static_cast<std::size_t>(kShapeComponents));
}

TEST_F(DepthProportions, OfNoPersonAreRefused) {
  StageRequest request = Request("proportions", "p1", {clips_[0]});
  request.options["point_clouds"]["tallest"] = 1.2;
  const auto refused = ProportionsStage(request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInconsistent);
  EXPECT_FALSE(std::filesystem::exists(request.output));
}

TEST_F(DepthProportions, FollowTheDeclaredHeight) {
  StageRequest request = Request("proportions", "p1", {clips_[0]});
  request.options["point_clouds"]["height"] = 1.2;
  const auto low = ProportionsStage(request);
  request.options["point_clouds"]["height"] = 1.8;
  const auto high = ProportionsStage(request);
  ASSERT_TRUE(low && high);
  EXPECT_NEAR(high->summary["scale"].get<double>(), 1.05, 0.05) << "the rest body measures 1.7 m from crown to soles";
  EXPECT_NEAR(high->summary["scale"].get<double>() / low->summary["scale"].get<double>(), 1.5, 1e-3);
}

TEST_F(DepthProportions, HeightThatThePointsContradictIsAnError) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  PointCloudOptions options;
  options.solver = PoseSolver::kBanded;
  for (const double scale : {kTaller, 0.5}) {
    std::vector<double> bones = skeleton->RestBoneLengths();
    for (double& bone : bones) bone *= scale;
    options.height = 1.7 * scale;
    const auto fit = FitClouds(clips_[0], skeleton, bones, options);
    ASSERT_TRUE(fit) << fit.error().Message();
    const auto reported = std::find_if(fit->findings.begin(), fit->findings.end(),
                                       [](const Finding& finding) { return finding.code == "height_contradicted"; });
    ASSERT_EQ(reported != fit->findings.end(), scale < 1.0);
    if (reported == fit->findings.end()) continue;
    EXPECT_EQ(reported->severity, Severity::kError);
    EXPECT_THAT(reported->message, HasSubstr("0.85 m"));
    EXPECT_EQ(reported->action, FindingAction::kKept);
  }
}

/// A desk hides the legs: they are inferred, and a finding reports it.
TEST_F(DepthProportions, ReportLegsThatNoViewShows) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  std::vector<double> bones = skeleton->RestBoneLengths();
  for (double& bone : bones) bone *= kTaller;
  PointCloudOptions options;
  options.solver = PoseSolver::kBanded;
  options.start.posture = StartPosture::kStanding;
  const auto unobserved_limbs = [&] {
    const auto fit = FitClouds(clips_[0], skeleton, bones, options);
    EXPECT_TRUE(fit) << fit.error().Message();
    std::string message;
    for (const Finding& finding : fit->findings) {
      if (finding.code == "limb_never_seen") message = finding.message;
    }
    return message;
  };
  EXPECT_EQ(unobserved_limbs(), "");
  for (const DepthView& view : clips_[0].evidence.depth_views) {
    auto image = ReadDepthImage(view.files[0]);
    ASSERT_TRUE(image);
    const auto hips = view.camera.ProjectWorld({0.1, 0.05, -0.05});
    ASSERT_TRUE(hips);
    for (int row = static_cast<int>(hips->y()); row < image->height; ++row) {
      for (int column = 0; column < image->width; ++column)
        image->values[static_cast<std::size_t>(row) * image->width + column] = 0;
    }
    ASSERT_TRUE(WriteDepthImage(*image, view.files[0]));
  }
  EXPECT_THAT(unobserved_limbs(), HasSubstr("left_knee, right_knee"));
}

TEST_F(DepthProportions, ImplausibleSizeMakesTheClipSuspect) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  for (const double scale : {kTaller, 2.0 * kTaller}) {
    Proportions body = EstimateProportions({}, skeleton, {});
    for (double& length : body.bone_length) length *= scale;
    ASSERT_TRUE(WriteFile(folder_ / "proportions.json", ProportionsJson(body, *skeleton).dump()));
    StageRequest request = Request("fitting", clips_[0].id(), {clips_[0]});
    request.inputs.push_back({"proportions", "p1", folder_ / "proportions.json", std::string(64, 'b')});
    const auto fitted = FittingStage(request);
    ASSERT_TRUE(fitted) << fitted.error().Message();
    const auto size = std::find_if(fitted->findings.begin(), fitted->findings.end(),
                                   [](const Finding& finding) { return finding.code == "size_suspect"; });
    ASSERT_EQ(size != fitted->findings.end(), scale > kTaller);
    if (size == fitted->findings.end()) continue;
    EXPECT_EQ(fitted->kind, OutcomeKind::kSuspect);
    EXPECT_GT(size->value, 2.5);
    EXPECT_THAT(size->message, HasSubstr("two people"));
  }
}

TEST_F(DepthProportions, RefuseClipsWithoutAnyUsableOneGivingTheFirstReason) {
  for (const Clip& clip : clips_) Damage(clip);
  const auto measured = Measure();
  ASSERT_FALSE(measured);
  EXPECT_THAT(measured.error().Message(), HasSubstr(clips_[0].id()));
  EXPECT_THAT(measured.error().Message(), HasSubstr("c0_0.png"));
}

}  // namespace
}  // namespace mocurate
