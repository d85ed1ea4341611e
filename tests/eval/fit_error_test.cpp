// Fits against truth: known errors are measured correctly.

#include <gmock/gmock.h>
#include <stdlib.h>

#include <filesystem>

#include "core/base/file.h"
#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "core/store/store.h"
#include "eval/stages.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

class FitErrors : public testing::Test {
 protected:
  void SetUp() override {
    const auto skeleton = LoadSkeleton("smpl24");
    ASSERT_TRUE(skeleton) << skeleton.error().Message();
    skeleton_ = *skeleton;
  }

  /// A person whose joints all rotate a little, differently in every frame.
  Motion Dancing(int frames, std::uint64_t seed) const {
    Random random(seed, "dance");
    std::vector<Vector3d> root(frames);
    std::vector<Quaterniond> rotation(static_cast<std::size_t>(frames) * skeleton_->joint_count());
    for (int f = 0; f < frames; ++f) root[f] = Vector3d(0.01 * f, 0.95, 0.02 * f);
    for (Quaterniond& q : rotation) {
      q = ExpQuaternion(0.3 * Vector3d(random.Normal(), random.Normal(), random.Normal()));
    }
    return MakeMotion(skeleton_, FrameRate{30, 1}, std::move(root), std::move(rotation), skeleton_->RestBoneLengths());
  }

  static Clip ClipOf(const Motion& motion, const std::string& recording) {
    Clip clip;
    clip.identity.source = "studio";
    clip.identity.person = "p1";
    clip.identity.recording = recording;
    clip.identity.end_frame = motion.frame_count();
    clip.rate = motion.rate;
    clip.motion = motion;
    return clip;
  }

  void AddFit(const Clip& clip) {
    Dataset fit;
    fit.skeleton = clip.motion->skeleton;
    fit.joints_only = clip.motion->joints_only();
    fit.clips = {clip};
    const auto path = folder_ / ("fit" + std::to_string(request_.inputs.size()) + ".h5");
    const Status written = WriteDataset(fit, path);
    ASSERT_TRUE(written) << written.error().Message();
    request_.inputs.push_back({"fit", clip.id(), path, ""});
  }

  void AddEvidence(Clip clip, JointTracks tracks) {
    clip.motion.reset();
    clip.evidence.tracks = std::move(tracks);
    const auto path = folder_ / ("evidence" + std::to_string(request_.inputs.size()) + ".h5");
    const Status written = WriteEvidence(clip, path);
    ASSERT_TRUE(written) << written.error().Message();
    request_.inputs.push_back({"evidence", clip.id(), path, ""});
  }

  void AddTruth(const std::map<std::string, Motion>& motion) {
    Truth truth;
    truth.motion = motion;
    const auto path = folder_ / "truth.h5";
    const Status written = WriteTruth(truth, path);
    ASSERT_TRUE(written) << written.error().Message();
    request_.inputs.push_back({"truth", "truth", path, ""});
  }

  nlohmann::json Scored() {
    request_.output = folder_ / "fit_error.json";
    const auto outcome = FitErrorStage(request_);
    if (!outcome) {
      ADD_FAILURE() << outcome.error().Message();
      return {};
    }
    return nlohmann::json::parse(*ReadFile(request_.output));
  }

  ScratchFolder folder_;
  SkeletonPtr skeleton_;
  StageRequest request_;
};

Motion Shifted(Motion motion, const Vector3d& by) {
  for (Vector3d& root : motion.root_translation) root += by;
  ComputeJoints(motion);
  return motion;
}

/// Every joint of a motion observed, `away` from where it is.
JointTracks TracksOf(const Motion& motion, const Vector3d& away) {
  JointTracks tracks;
  for (const Joint& joint : motion.skeleton->joints) tracks.names.push_back(joint.name);
  tracks.positions = motion.joints;
  for (int f = 0; f < motion.frame_count(); ++f) {
    tracks.time_s.push_back(motion.rate.FrameTime(f));
    for (int j = 0; j < motion.joint_count(); ++j) tracks.positions.at(f, j) += away;
  }
  tracks.confidence.assign(static_cast<std::size_t>(motion.frame_count()) * motion.joint_count(), 1.0);
  return tracks;
}

TEST_F(FitErrors, AFitShiftedByTenMillimetresIsTenMillimetresAwayAndTurnedByNothing) {
  const Motion truth = Dancing(8, 1);
  const Clip fit = ClipOf(Shifted(truth, Vector3d(0.006, 0.0, 0.008)), "a");
  AddFit(fit);
  AddTruth({{fit.id(), truth}});
  const nlohmann::json scored = Scored();
  EXPECT_NEAR(scored.at("joint_mm"), 10.0, 1e-2);
  EXPECT_NEAR(scored.at("rotation_deg"), 0.0, 1e-3);
  EXPECT_NEAR(scored.at("bone_direction_deg"), 0.0, 1e-2);
  EXPECT_EQ(scored.at("evidence_mm"), 0.0);
  EXPECT_EQ(scored.at("frames"), 8);
}

TEST_F(FitErrors, APersonTurnedByFiveDegreesIsTurnedByFiveDegrees) {
  const Motion truth = Dancing(8, 2);
  Motion turned = truth;
  const Quaterniond by = ExpQuaternion(Vector3d(0.0, 5.0 * kDegree, 0.0));
  for (int f = 0; f < turned.frame_count(); ++f) turned.rotation_at(f, 0) = by * turned.rotation_at(f, 0);
  ComputeJoints(turned);
  const Clip fit = ClipOf(turned, "a");
  AddFit(fit);
  AddTruth({{fit.id(), truth}});
  const nlohmann::json scored = Scored();
  EXPECT_NEAR(scored.at("rotation_deg"), 5.0, 1e-3);
  EXPECT_GT(scored.at("bone_direction_deg"), 1.0);
  EXPECT_LT(scored.at("bone_direction_deg"), 5.0);  // a bone along the axis does not move
}

TEST_F(FitErrors, StatedUncertaintyCoversErrorsThatItDescribes) {
  const Motion truth = Dancing(400, 6);
  Motion fitted = truth;
  fitted.rotation.clear();
  fitted.root_translation.clear();
  fitted.bone_length.clear();
  Random random(5, "errors");
  for (int f = 0; f < truth.frame_count(); ++f) {
    for (int j = 0; j < truth.joint_count(); ++j) {
      // Variances 1, 4 and 9 cm^2, x and y correlated by one half.
      const double x = random.Normal();
      const double y = 0.5 * x + std::sqrt(0.75) * random.Normal();
      fitted.joints.at(f, j) += Vector3d(0.01 * x, 0.02 * y, 0.03 * random.Normal());
      for (const float c : {1e-4F, 1e-4F, 0.0F, 4e-4F, 0.0F, 9e-4F}) fitted.position_cov.push_back(c);
    }
  }
  const Clip fit = ClipOf(fitted, "a");
  AddFit(fit);
  AddTruth({{fit.id(), truth}});
  const nlohmann::json scored = Scored();
  EXPECT_NEAR(scored.at("within_one_sigma"), 0.683, 0.01);
  EXPECT_NEAR(scored.at("within_two_sigma"), 0.954, 0.005);
}

TEST_F(FitErrors, AFitThatStatesNoUncertaintyHasNoCoverage) {
  const Motion truth = Dancing(8, 6);
  AddFit(ClipOf(truth, "a"));
  AddTruth({{ClipOf(truth, "a").id(), truth}});
  EXPECT_FALSE(Scored().contains("within_one_sigma"));
}

TEST_F(FitErrors, NoiseOfTheEvidenceIsMeasuredOnObservedSamplesOnly) {
  const Motion truth = Dancing(8, 3);
  const Clip fit = ClipOf(truth, "a");
  JointTracks tracks = TracksOf(truth, Vector3d(0.0, 0.02, 0.0));
  tracks.confidence[3] = 0.0;  // joint 3 of the first frame
  tracks.positions.at(0, 3) = Vector3d(100.0, 100.0, 100.0);
  AddFit(fit);
  AddEvidence(fit, tracks);
  AddTruth({{fit.id(), truth}});
  const nlohmann::json scored = Scored();
  EXPECT_NEAR(scored.at("evidence_mm"), 20.0, 1e-2);
  EXPECT_NEAR(scored.at("joint_mm"), 0.0, 1e-2);
}

TEST_F(FitErrors, LongClipsWeighMore) {
  const Motion brief = Dancing(5, 4);
  const Motion lengthy = Dancing(15, 5);
  const Clip first = ClipOf(Shifted(brief, Vector3d(0.01, 0.0, 0.0)), "a");
  const Clip second = ClipOf(Shifted(lengthy, Vector3d(0.02, 0.0, 0.0)), "b");
  AddFit(first);
  AddFit(second);
  AddTruth({{first.id(), brief}, {second.id(), lengthy}});
  const nlohmann::json scored = Scored();
  EXPECT_EQ(scored.at("clips"), 2);
  EXPECT_NEAR(scored.at("joint_mm"), (5.0 * 10.0 + 15.0 * 20.0) / 20.0, 1e-2);
  EXPECT_NEAR(scored.at("per_clip").at(first.id()).at("joint_mm"), 10.0, 1e-2);
  EXPECT_NEAR(scored.at("per_clip").at(second.id()).at("joint_mm"), 20.0, 1e-2);
}

TEST_F(FitErrors, ATruthOfAnotherCaptureIsAnError) {
  const Motion truth = Dancing(4, 6);
  AddFit(ClipOf(truth, "a"));
  AddTruth({{"studio/p9/unknown#0-4", truth}});
  request_.output = folder_ / "fit_error.json";
  const auto outcome = FitErrorStage(request_);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().code, ErrorCode::kInconsistent);
  EXPECT_THAT(outcome.error().Message(), testing::HasSubstr("no fitted clip has a truth of its id"));
  EXPECT_FALSE(std::filesystem::exists(request_.output));
}

TEST_F(FitErrors, AFitOfAnotherLengthThanItsTruthIsAnErrorWithBothLengths) {
  const Clip fit = ClipOf(Dancing(4, 7), "a");
  AddFit(fit);
  AddTruth({{fit.id(), Dancing(6, 7)}});
  request_.output = folder_ / "fit_error.json";
  const auto outcome = FitErrorStage(request_);
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().what, "the fit has 4 frames, the truth 6");
}

}  // namespace
}  // namespace mocurate
