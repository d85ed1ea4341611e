// Fits against truth: known errors are measured correctly.

#include <gmock/gmock.h>
#include <stdlib.h>

#include <filesystem>
#include <set>

#include "core/base/file.h"
#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "core/store/store.h"
#include "eval/metrics/sigma_quality.h"
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

  /// Motions as the truth, in a dataset that was moved from the source's world.
  void AddTruthAsDataset(const std::vector<Clip>& clips) {
    Dataset dataset;
    dataset.skeleton = skeleton_;
    dataset.clips = clips;
    for (Clip& clip : dataset.clips)
      Transform({ExpQuaternion(Vector3d(0.0, -1.0, 0.0)), Vector3d(3.0, 0.0, 1.0)}, clip);
    const auto path = folder_ / "truth.h5";
    const Status written = WriteDataset(dataset, path);
    ASSERT_TRUE(written) << written.error().Message();
    request_.inputs.push_back({"truth", "truth", path, ""});
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
  EXPECT_EQ(scored.at("within_quarters_of_sigma").at(3), scored.at("within_one_sigma"));
  const nlohmann::json& sigma = scored.at("sigma");
  EXPECT_EQ(sigma.at("large_error_mm"), 50.0);
  EXPECT_EQ(sigma.at("by_evidence"), nlohmann::json::object());
  const std::pair<const char*, int> joints[] = {{"all", 24}, {"trunk", 6}, {"head", 2},
                                                {"arms", 8}, {"legs", 8},  {"not_observed", 0}};
  for (const auto& [group, count] : joints) {
    const nlohmann::json& positions = sigma.at("groups").at(group).at("positions");
    EXPECT_EQ(positions.at("samples"), 400 * count) << group;
    EXPECT_TRUE(positions.at("spearman").is_null()) << "one deviation: no order";
    if (count == 0) {
      for (const char* key : {"within_one_sigma", "ece", "risk_coverage_mm", "aurc_mm", "ideal_aurc_mm", "auc"})
        EXPECT_TRUE(positions.at(key).is_null()) << key;
      continue;
    }
    EXPECT_LT(positions.at("ece"), 0.02) << group;
    EXPECT_EQ(positions.at("auc"), 0.5) << group;
    EXPECT_EQ(positions.at("risk_coverage_mm").size(), 10U);
    EXPECT_NEAR(positions.at("risk_coverage_mm").back(), scored.at("joint_mm"), 2.0);
    EXPECT_LT(positions.at("ideal_aurc_mm"), positions.at("aurc_mm"));
  }
  EXPECT_EQ(sigma.at("groups").at("all").at("rotations").at("samples"), 0);
  EXPECT_EQ(sigma.at("warnings").at(0).at("code"), "no_rotation_sigma");
}

TEST(BodyParts, TheHeadHangsFromWhereTheArmsMeet) {
  for (const auto& [name, head] : {std::pair("kinect20", std::set<std::string>{"head"}),
                                   {"cmu31", {"lowerneck", "upperneck", "head"}},
                                   {"ntu18", {"nose", "head_top"}},
                                   {"ntu14", {}}}) {
    const SkeletonPtr skeleton = LoadSkeleton(name).value();
    const std::vector<BodyPart> parts = BodyPartsOf(*skeleton);
    std::set<std::string> found;
    for (std::size_t j = 0; j < parts.size(); ++j) {
      if (parts[j] == BodyPart::kHead) found.insert(skeleton->joints[j].name);
    }
    EXPECT_EQ(found, head) << name;
  }
}

TEST_F(FitErrors, RotationsCountAboutTheAxesThatTheFitMarksAsObserved) {
  const Motion truth = Dancing(200, 8);
  Motion fitted = truth;
  Random random(9, "errors");
  for (int f = 0; f < truth.frame_count(); ++f) {
    for (int j = 0; j < truth.joint_count(); ++j) {
      const double sigma = random.Uniform(0.01, 0.1);
      const Vector3d error(sigma * random.Normal(), 0.5 * sigma * random.Normal(), 0.3 * random.Normal());
      fitted.rotation_at(f, j) = truth.rotation_at(f, j) * ExpQuaternion(error);
      for (const double stated : {sigma, 0.5 * sigma, 0.01})
        fitted.rotation_sigma.push_back(static_cast<float>(stated));
      for (const float observed : {0.9F, 0.2F, 0.05F}) fitted.rotation_observed.push_back(observed);
      fitted.state.push_back(j < 4 ? JointState::kInferred : JointState::kObserved);
    }
  }
  ComputeJoints(fitted);
  const Clip fit = ClipOf(fitted, "a");
  AddFit(fit);
  AddTruth({{fit.id(), truth}});
  const nlohmann::json scored = Scored();
  const nlohmann::json& sigma = scored.at("sigma");
  const nlohmann::json& rotations = sigma.at("groups").at("all").at("rotations");
  EXPECT_EQ(rotations.at("samples"), 200 * 24 * 2) << "not the third axis";
  EXPECT_NEAR(rotations.at("within_one_sigma"), 0.683, 0.03);
  EXPECT_NEAR(rotations.at("within_two_sigma"), 0.954, 0.02);
  EXPECT_GT(rotations.at("spearman"), 0.3);
  EXPECT_EQ(sigma.at("groups").at("not_observed").at("rotations").at("samples"), 200 * 4 * 2);
  EXPECT_EQ(sigma.at("warnings").size(), 1U);
  EXPECT_EQ(sigma.at("warnings").at(0).at("code"), "no_position_cov");
  EXPECT_FALSE(scored.contains("within_one_sigma"));
}

/// `motion` with a covariance of `sigma` metres for every joint.
Motion WithPositionCov(Motion motion, float sigma) {
  for (int i = 0; i < motion.frame_count() * motion.joint_count(); ++i) {
    for (const float unit : {1.0F, 0.0F, 0.0F, 1.0F, 0.0F, 1.0F}) motion.position_cov.push_back(sigma * sigma * unit);
  }
  return motion;
}

TEST_F(FitErrors, ClipsOfDifferentEvidenceAreMeasuredApart) {
  const Motion truth = Dancing(6, 10);
  const Clip tracked = ClipOf(WithPositionCov(Shifted(truth, Vector3d(0.01, 0.0, 0.0)), 0.02F), "a");
  const Clip given = ClipOf(WithPositionCov(Shifted(truth, Vector3d(0.06, 0.0, 0.0)), 0.03F), "b");
  AddFit(tracked);
  AddFit(given);
  AddEvidence(tracked, TracksOf(truth, Vector3d::Zero()));
  AddTruth({{tracked.id(), truth}, {given.id(), truth}});
  const nlohmann::json scored = Scored();
  const nlohmann::json &sigma = scored.at("sigma"), &kinds = sigma.at("by_evidence");
  EXPECT_EQ(kinds.size(), 2U);
  EXPECT_NEAR(kinds.at("joint_tracks").at("all").at("positions").at("aurc_mm"), 10.0, 1e-2);
  EXPECT_NEAR(kinds.at("motion").at("legs").at("positions").at("aurc_mm"), 60.0, 1e-2);
  const nlohmann::json& all = sigma.at("groups").at("all").at("positions");
  EXPECT_EQ(all.at("auc"), 1.0);
  EXPECT_GT(all.at("spearman"), 0.8) << "errors differ by the rounding of the file";
  EXPECT_NEAR(all.at("risk_coverage_mm").at(4), 10.0, 1e-2);
  EXPECT_NEAR(all.at("risk_coverage_mm").at(9), 35.0, 1e-2);
}

TEST_F(FitErrors, ClipsOfADatasetAreComparedInTheWorldAndAtTheTimesOfTheirRecording) {
  const Clip recording = ClipOf(Dancing(40, 11), "a");
  auto cut = Cut(Resample(recording, FrameRate{10, 1}), 3, 9);
  ASSERT_TRUE(cut) << cut.error().Message();
  Transform({ExpQuaternion(Vector3d(0.0, 2.0, 0.0)), Vector3d(1.0, -0.9, 2.0)}, *cut);
  EXPECT_EQ(cut->id(), "studio/p1/a#9-27");
  AddFit(*cut);
  Clip other = ClipOf(Dancing(5, 12), "b");
  AddFit(other);
  AddTruthAsDataset({recording});
  const nlohmann::json scored = Scored();
  EXPECT_EQ(scored.at("frames"), 6);
  EXPECT_NEAR(scored.at("joint_mm"), 0.0, 2e-2);
  EXPECT_NEAR(scored.at("rotation_deg"), 0.0, 1e-2);
  EXPECT_EQ(scored.at("without_truth"), nlohmann::json({other.id()}));
}

TEST_F(FitErrors, AFitThatStatesNoUncertaintyHasNoCoverage) {
  const Motion truth = Dancing(8, 6);
  AddFit(ClipOf(truth, "a"));
  AddTruth({{ClipOf(truth, "a").id(), truth}});
  const nlohmann::json scored = Scored();
  EXPECT_FALSE(scored.contains("within_one_sigma"));
  EXPECT_EQ(scored.at("sigma").at("groups").at("all").at("positions").at("samples"), 0);
  EXPECT_EQ(scored.at("sigma").at("warnings").at(0),
            nlohmann::json({{"code", "no_position_cov"},
                            {"clips", 1},
                            {"message", "1 clip: no position_cov, so their positions are not measured"}}));
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
