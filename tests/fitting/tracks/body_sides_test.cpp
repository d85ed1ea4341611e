#include "fitting/repair/body_sides.h"
#include "fitting/repair/track_repairs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fitting/evidence/detector_points.h"
#include "fitting/fit_outcome.h"
#include "fitting/keypoint_fit.h"
#include "tests/fitting/keypoint_takes.h"
#include "tests/fitting/takes.h"
#include "tests/fitting/track_problems.h"

namespace mocurate {
namespace {

constexpr int kFrames = 90;

/// A person who swings arms and legs, tracked with 10 mm of noise; left and right are exchanged in frames [begin, end).
struct MistakenClip {
  Motion truth = Swinging(kFrames);
  SkeletonTracks tracks;

  MistakenClip(int begin, int end) {
    tracks.skeleton = truth.skeleton;
    tracks.positions = truth.joints;
    tracks.confidence.assign(static_cast<std::size_t>(kFrames) * truth.joint_count(), 1.0);
    for (int f = 0; f < kFrames; ++f) tracks.time_s.push_back(truth.rate.FrameTime(f));
    AddNoise(tracks, 0.01, 7);
    ExchangeJoints(LeftJoints(*truth.skeleton), begin, end, tracks);
  }

  FitResult Fit() const {
    auto fit = RepairAndFit(tracks, truth.rate, truth.bone_length, {}, {});
    EXPECT_TRUE(fit.has_value()) << fit.error().Message();
    return std::move(*fit);
  }
};

TEST(ExchangedBody, PartOfAJointTrackIsExchangedBackWhicheverPartIsLonger) {
  const FitResult sound = MistakenClip(0, 0).Fit();
  for (const auto& [begin, end] : {std::pair{60, 90}, {20, 90}, {0, 75}}) {
    const MistakenClip clip(begin, end);
    const FitResult fit = clip.Fit();
    EXPECT_LT(RmsError(fit.motion.joints, clip.truth.joints), 1.1 * RmsError(sound.motion.joints, clip.truth.joints))
        << begin << " to " << end;
    const int knee = *clip.truth.skeleton->FindJoint("left_knee");
    for (int f = 0; f < kFrames; ++f) {
      const JointState state = fit.motion.state[static_cast<std::size_t>(f) * 24 + static_cast<std::size_t>(knee)];
      EXPECT_EQ(state == JointState::kRepaired, f >= begin && f < end) << f;
    }
  }
}

TEST(ExchangedBody, TakesRecordedRotationsAlong) {
  MistakenClip clip(0, 0);
  SkeletonTracks& tracks = clip.tracks;
  for (std::size_t at = 0; at < tracks.confidence.size(); ++at) {
    tracks.rotation.push_back(ExpQuaternion(Vector3d(0.001 * static_cast<double>(at), 0.0, 0.0)));
    tracks.rotation_confidence.push_back(at % 2 == 0 ? 1.0 : 0.5);
  }
  const SkeletonTracks before = tracks;
  const std::vector<int> left = LeftJoints(*tracks.skeleton);
  ExchangeJoints(left, 10, 20, tracks);
  const auto at = [&](int f, int j) { return static_cast<std::size_t>(f * tracks.joints() + j); };
  for (const int joint : left) {
    const int partner = tracks.skeleton->joints[joint].mirror;
    EXPECT_EQ(tracks.rotation[at(15, joint)].coeffs(), before.rotation[at(15, partner)].coeffs());
    EXPECT_EQ(tracks.rotation_confidence[at(15, partner)], before.rotation_confidence[at(15, joint)]);
    EXPECT_EQ(tracks.rotation[at(5, joint)].coeffs(), before.rotation[at(5, joint)].coeffs());
  }
}

/// The tracker takes the back for the front: left and right are reversed, and feet and knees point to the back.
TEST(ExchangedBody, ReversedPersonIsReportedAndKept) {
  MistakenClip clip(0, 0);
  SkeletonTracks& tracks = clip.tracks;
  const std::vector<int> left = LeftJoints(*tracks.skeleton);
  for (int f = 60; f < kFrames; ++f) {
    const Vector3d root = tracks.positions.at(f, 0);
    const Vector3d side =
        Vector3d(tracks.positions.at(f, left[0]) - tracks.positions.at(f, tracks.skeleton->joints[left[0]].mirror))
            .normalized();
    const Vector3d front = side.cross(Vector3d::UnitY()).normalized();
    for (int j = 0; j < tracks.joints(); ++j) {
      const Vector3d from = tracks.positions.at(f, j) - root;
      tracks.positions.at(f, j) = root + from - 2.0 * front * front.dot(from);  // back to front
    }
    ExchangeJoints(left, f, f + 1, tracks);
  }
  const RepairedTracks repaired = RepairTracks(tracks, clip.truth.bone_length, 0.01, {});
  EXPECT_EQ(repaired.tracks.positions.xyz, tracks.positions.xyz);
  ASSERT_EQ(repaired.findings.size(), 1u);
  EXPECT_EQ(repaired.findings[0].code, "body_turned");
  EXPECT_EQ(repaired.findings[0].frame_begin, 60);
}

/// Tracks cannot distinguish exchanged names from mirrored axes: the finding names both.
TEST(ExchangedBody, WholeJointTrackIsAnErrorThatNamesBothExplanations) {
  const MistakenClip clip(0, kFrames);
  const FitResult fit = clip.Fit();
  Clip source;
  source.identity.recording = "mistaken";
  const StageOutcome outcome = OutcomeOfFit(source, fit, FittingOptions{});
  EXPECT_EQ(outcome.kind, OutcomeKind::kSuspect);
  ASSERT_EQ(outcome.findings.size(), 1u);
  EXPECT_EQ(outcome.findings[0].code, "sides_exchanged");
  EXPECT_EQ(outcome.findings[0].severity, Severity::kError);
  EXPECT_THAT(outcome.findings[0].message, testing::HasSubstr("backwards"));
  EXPECT_THAT(outcome.findings[0].message, testing::HasSubstr("axes are mirrored"));
  FitResult sound = MistakenClip(0, 0).Fit();
  EXPECT_EQ(OutcomeOfFit(source, sound, FittingOptions{}).kind, OutcomeKind::kDone);
  sound.rejected_share = 0.4;
  EXPECT_EQ(OutcomeOfFit(source, sound, FittingOptions{}).kind, OutcomeKind::kSuspect);
}

/// Exchanges left and right keypoints of every view in frames [begin, end): all of them, or those of a limb.
void CallLeftRight(Evidence& evidence, int begin, int end, const std::vector<std::string>& limb = {}) {
  const std::size_t keypoints = evidence.keypoint_names.size();
  for (KeypointView& view : evidence.keypoint_views) {
    for (std::size_t k = 0; k < keypoints; ++k) {
      if (evidence.keypoint_names[k].rfind("left_", 0) != 0) continue;
      const std::string part = evidence.keypoint_names[k].substr(5);
      if (!limb.empty() && std::find(limb.begin(), limb.end(), part) == limb.end()) continue;
      const std::string partner = "right_" + part;
      const auto other =
          static_cast<std::size_t>(std::find(evidence.keypoint_names.begin(), evidence.keypoint_names.end(), partner) -
                                   evidence.keypoint_names.begin());
      for (int f = begin; f < end; ++f) {
        double* frame = view.values.data() + 3 * static_cast<std::size_t>(f) * keypoints;
        std::swap_ranges(frame + 3 * k, frame + 3 * k + 3, frame + 3 * other);
      }
    }
  }
}

/// Fits the keypoints with the bones that they were made with.
FitResult FitOnOwnBody(const Evidence& evidence, const Motion& truth, const FittingOptions& options) {
  auto result = FitKeypoints(evidence, truth.rate, truth.skeleton, truth.skeleton, truth.bone_length, options);
  EXPECT_TRUE(result.has_value()) << result.error().Message();
  return std::move(*result);
}

/// Rays of a limb that all views label with the other side intersect as well as any.
TEST(ExchangedLimb, IsExchangedBackInAllViewsAndReported) {
  const Motion truth = Swinging(kFrames);
  const Evidence sound = Detections(Ring(4), {truth}, 2.0);
  const auto fit = [&](const Evidence& evidence, const FittingOptions& options) {
    return FitOnOwnBody(evidence, truth, options);
  };
  const FitResult undisturbed = fit(sound, {});
  EXPECT_TRUE(undisturbed.track_repairs.empty());
  for (const std::vector<std::string>& limb :
       {std::vector<std::string>{"elbow", "wrist", "hand"}, {"knee", "ankle", "foot"}}) {
    Evidence mistaken = sound;
    CallLeftRight(mistaken, 40, 60, limb);
    const FitResult corrected = fit(mistaken, {});
    EXPECT_LT(RmsError(corrected.motion.joints, truth.joints), 1.1 * RmsError(undisturbed.motion.joints, truth.joints))
        << limb[0];
    EXPECT_THAT(corrected.track_repairs, testing::HasSubstr("\"frames\":[40,60]")) << limb[0];
    const int joint = *truth.skeleton->FindJoint("left_" + limb[0]);
    EXPECT_EQ(corrected.motion.state[std::size_t{50} * 24 + static_cast<std::size_t>(joint)], JointState::kRepaired);

    FittingOptions report_only;
    report_only.keypoints.audit.sides = AuditAction::kReport;
    EXPECT_TRUE(fit(mistaken, report_only).track_repairs.empty()) << "only what the audit may correct";
  }
}

TEST(ExchangedBody, IsExchangedBackInAllViewsAndReported) {
  const Motion truth = Swinging(kFrames);
  const Evidence sound = Detections(Ring(4), {truth}, 2.0);
  const auto fit = [&](const Evidence& evidence, const FittingOptions& options) {
    return FitOnOwnBody(evidence, truth, options);
  };
  const double undisturbed = RmsError(fit(sound, {}).motion.joints, truth.joints);
  EXPECT_TRUE(fit(sound, {}).keypoints->faults.empty());
  for (const auto& [begin, end] : {std::pair{0, kFrames}, {40, kFrames}, {0, 70}}) {
    Evidence mistaken = sound;
    CallLeftRight(mistaken, begin, end);
    const FitResult corrected = fit(mistaken, {});
    EXPECT_LT(RmsError(corrected.motion.joints, truth.joints), 1.1 * undisturbed) << begin << " to " << end;
    ASSERT_EQ(corrected.keypoints->faults.size(), 1u);
    const RigFault& fault = corrected.keypoints->faults[0];
    EXPECT_EQ(fault.code, "views_swap_sides");
    EXPECT_EQ(fault.frame_begin, begin);
    EXPECT_EQ(fault.frame_end, end);
    EXPECT_TRUE(fault.corrected);
    EXPECT_THAT(corrected.rig_audit, testing::HasSubstr("views_swap_sides"));
    EXPECT_EQ(corrected.motion.state[static_cast<std::size_t>(begin) * 24 + 4], JointState::kRepaired);

    FittingOptions report_only;
    report_only.keypoints.audit.sides = AuditAction::kReport;
    const FitResult reported_fit = fit(mistaken, report_only);
    EXPECT_TRUE(reported_fit.keypoints->suspect);
    EXPECT_GT(RmsError(reported_fit.motion.joints, truth.joints), 0.1);
  }
}

/// COCO's keypoints have no toes; the face shows the front of a person who stands upright.
TEST(ExchangedBody, FaceShowsTheExchangeOfAnUprightPerson) {
  const std::vector<std::string> names = {"nose", "left_ear", "right_ear"};
  const SkeletonPtr body = WithDetectorPoints(*LoadSkeleton("smpl24"), names);
  const std::vector<Quaterniond> still(static_cast<std::size_t>(kFrames) * body->joints.size(),
                                       Quaterniond::Identity());
  const Motion standing = MakeMotion(body, FrameRate{30, 1}, std::vector<Vector3d>(kFrames, Vector3d(0, 0.93, 0)),
                                     still, body->RestBoneLengths());
  SkeletonTracks tracks;
  tracks.skeleton = body;
  tracks.positions = standing.joints;
  for (int f = 0; f < kFrames; ++f) {
    tracks.time_s.push_back(standing.rate.FrameTime(f));
    for (const Joint& joint : body->joints)
      tracks.confidence.push_back(joint.name.find("foot") == std::string::npos ? 1.0 : 0.0);
  }
  AddNoise(tracks, 0.01, 3);
  EXPECT_TRUE(FindBodyExchanges(tracks, 0.01, 10.0).empty());
  ExchangeJoints(LeftJoints(*body), 0, kFrames, tracks);
  const auto found = FindBodyExchanges(tracks, 0.01, 10.0);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(CoverAll(found, tracks));
  EXPECT_THAT(found[0].evidence, testing::HasSubstr("the face lies behind the ears"));
}

}  // namespace
}  // namespace mocurate
