// People in the keypoints of several calibrated views: association, triangulation, and refusals without a person.

#include "core/base/median.h"
#include "fitting/triangulation/keypoint_tracks.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <map>

#include "tests/fitting/keypoint_takes.h"

namespace mocurate {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const Skeleton& SmplBody() {
  static const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  return *skeleton;
}

Expected<KeypointTracks> TriangulatedSubject(Evidence evidence, int subject = 0) {
  evidence.subject = subject;
  return TriangulateKeypoints(evidence, SmplBody(), {});
}

std::string WhyRefused(const Evidence& evidence, int subject = 0) {
  const auto found = TriangulatedSubject(evidence, subject);
  return found ? "not refused" : found.error().Message();
}

const Finding* FindingWithCode(const KeypointTracks& found, const std::string& code) {
  for (const Finding& finding : found.findings) {
    if (finding.code == code) return &finding;
  }
  return nullptr;
}

TEST(KeypointTracks, AreTheJointsOfTheOnlyPerson) {
  const Motion person = Swinging(20);
  const auto found = TriangulatedSubject(Detections(Ring(4), {person}, 0.0));
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_LT(MeanError(found->tracks, person), 1e-6);
  EXPECT_EQ(found->report.people, 1);
  EXPECT_NEAR(found->report.triangulated, 1.0, 1e-12);
  EXPECT_TRUE(found->findings.empty()) << found->findings[0].message;
}

TEST(KeypointTracks, SeparatePeopleWhoStandCloseInAnyOrder) {
  const Motion adult = Swinging(40, 1.0, {-0.35, 0, 0});
  const Motion child = Swinging(40, 0.7, {0.35, 0, 0.2});
  const Evidence evidence = Detections(Ring(4), {adult, child}, 3.0, 0.1);
  const auto first = TriangulatedSubject(evidence, 0);
  const auto second = TriangulatedSubject(evidence, 1);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->report.people, 2);
  const bool adult_first = MeanError(first->tracks, adult) < MeanError(first->tracks, child);
  EXPECT_LT(MeanError(first->tracks, adult_first ? adult : child), 0.025);
  EXPECT_LT(MeanError(second->tracks, adult_first ? child : adult), 0.025);
}

TEST(KeypointTracks, FollowPeopleBeforeThirtyTwoCameras) {
  const Motion adult = Swinging(4, 1.0, {-0.5, 0, 0});
  const Motion other = Swinging(4, 0.9, {0.5, 0, 0.3});
  const auto found = TriangulatedSubject(Detections(Ring(32), {adult, other}, 3.0, 0.1));
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_EQ(found->report.people, 2);
  EXPECT_GT(found->report.views, 20.0);
}

TEST(KeypointTracks, ExcludeABystanderInOneCameraOnly) {
  const Motion person = Swinging(30);
  const Motion bystander = Swinging(30, 1.0, {1.5, 0, -1.0});
  Evidence evidence = Detections(Ring(4), {person, bystander}, 2.0);
  for (std::size_t c = 1; c < 4; ++c) {
    const Evidence alone = Detections(Ring(4), {person}, 2.0);
    evidence.keypoint_views[c] = alone.keypoint_views[c];
  }
  const auto found = TriangulatedSubject(evidence);
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_LT(MeanError(found->tracks, person), 0.015);
  EXPECT_EQ(found->report.people, 1);
  const Finding* excluded = FindingWithCode(*found, "bystanders_skipped");
  ASSERT_NE(excluded, nullptr);
  EXPECT_EQ(excluded->value, 30);
  EXPECT_THAT(excluded->message, HasSubstr("cam1 30 of 60"));
}

TEST(KeypointTracks, KeepIdentitiesThroughAGap) {
  const Motion person = Swinging(90);
  Evidence evidence = Detections(Ring(4), {person}, 2.0);
  for (KeypointView& view : evidence.keypoint_views) {
    for (int f = 30; f < 60; ++f) {
      for (int k = 0; k < 24; ++k) view.values[3 * (static_cast<std::size_t>(f) * 24 + k) + 2] = 0.0;
    }
  }
  const auto found = TriangulatedSubject(evidence);
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_EQ(found->report.people, 1);
  EXPECT_NEAR(found->report.seen_share, 2.0 / 3.0, 0.05);
}

TEST(KeypointTracks, NameAndCorrectAMovedCamera) {
  const Motion person = Swinging(30);
  Evidence evidence = Detections(Ring(5), {person}, 2.0);
  evidence.keypoint_views[2].camera.camera_from_world.translation += Vector3d(0.25, 0, 0);
  const auto found = TriangulatedSubject(evidence);
  ASSERT_TRUE(found) << found.error().Message();
  const Finding* moved = FindingWithCode(*found, "camera_moved");
  ASSERT_NE(moved, nullptr);
  EXPECT_THAT(moved->message, HasSubstr("cam3"));
  EXPECT_EQ(moved->action, FindingAction::kRepaired);
  EXPECT_NEAR(moved->value, 250.0, 15.0);  // mm
  EXPECT_GT(found->report.views, 4.9);
  EXPECT_LT(MeanError(found->tracks, person), 0.02);
}

/// Cameras whose every second keypoint is of a frame far away, as if they showed another take of the person.
Evidence WithAnotherTake(const Evidence& evidence, std::size_t cameras) {
  Evidence other = evidence;
  const std::size_t row = 3 * evidence.keypoint_names.size();
  for (std::size_t c = 0; c < cameras; ++c) {
    const std::vector<double>& given = evidence.keypoint_views[c].values;
    for (std::size_t i = 0; i < given.size(); i += 6) {
      for (std::size_t k = 0; k < 3; ++k) {
        const double moved = k == 0 ? 90.0 + 60.0 * static_cast<double>(c) : 0.0;  // px, beyond the outlier threshold
        other.keypoint_views[c].values[i + k] = given[(i + 10 * row) % given.size() + k] + moved;
      }
    }
  }
  return other;
}

TEST(KeypointTracks, ReportACameraThatDisagreesInPartAndCamerasThatContradict) {
  const Evidence sound = Detections(Ring(4), {Swinging(30)}, 2.0);
  KeypointFitOptions options;
  options.audit.moved = options.audit.clocks = options.audit.exchanged = options.audit.sides = AuditAction::kOff;
  const auto good = TriangulateKeypoints(sound, SmplBody(), options);
  ASSERT_TRUE(good) << good.error().Message();
  EXPECT_EQ(FindingWithCode(*good, "camera_disagrees_in_part"), nullptr);
  EXPECT_EQ(FindingWithCode(*good, "keypoints_contradict"), nullptr);
  const auto one = TriangulateKeypoints(WithAnotherTake(sound, 1), SmplBody(), options);
  ASSERT_TRUE(one) << one.error().Message();
  const Finding* in_part = FindingWithCode(*one, "camera_disagrees_in_part");
  ASSERT_NE(in_part, nullptr);
  EXPECT_THAT(in_part->message, HasSubstr("cam1"));
  EXPECT_NEAR(in_part->value, 0.5, 0.1);
  EXPECT_EQ(FindingWithCode(*one, "keypoints_contradict"), nullptr);
  const auto three = TriangulateKeypoints(WithAnotherTake(sound, 3), SmplBody(), options);
  ASSERT_TRUE(three) << three.error().Message();
  ASSERT_NE(FindingWithCode(*three, "keypoints_contradict"), nullptr);
  EXPECT_TRUE(three->report.suspect);
}

/// Wrists triangulated from the rotated camera and one other would be decimetres off.
TEST(KeypointTracks, AreNotTriangulatedFromADisagreeingCameraAndOneOther) {
  const Motion person = Swinging(30);
  Evidence evidence = Detections(Ring(4), {person}, 2.0);
  RigidTransform& pose = evidence.keypoint_views[1].camera.camera_from_world;
  pose = RigidTransform{ExpQuaternion(Vector3d(0, 0.06, 0)), Vector3d::Zero()} * pose;
  const auto keypoints = evidence.keypoint_names.size();
  const auto wrist = static_cast<std::size_t>(*person.skeleton->FindJoint("left_wrist"));
  for (const std::size_t c : {0u, 2u}) {
    auto& values = evidence.keypoint_views[c].values;
    for (std::size_t i = wrist; 3 * i < values.size(); i += keypoints) values[3 * i + 2] = 0.0;
  }
  KeypointFitOptions options;
  options.audit.moved = options.audit.clocks = AuditAction::kReport;
  const auto found = TriangulateKeypoints(evidence, SmplBody(), options);
  ASSERT_TRUE(found) << found.error().Message();
  const Finding* reported = FindingWithCode(*found, "camera_disagrees");
  ASSERT_NE(reported, nullptr);
  EXPECT_THAT(reported->message, HasSubstr("cam2"));
  EXPECT_EQ(reported->action, FindingAction::kExcluded);
  double worst = 0.0;
  for (int f = 0; f < found->tracks.positions.frames; ++f) {
    const auto at = static_cast<std::size_t>(f) * keypoints + wrist;
    if (found->tracks.confidence[at] <= 0.0) continue;
    const auto k = static_cast<int>(wrist);
    worst = std::max(worst, (found->tracks.positions.at(f, k) - person.joints.at(f, k)).norm());
  }
  EXPECT_LT(worst, 0.05);
  EXPECT_LT(MeanError(found->tracks, person), 0.02);
}

TEST(KeypointTracks, RefuseDifferentImagesFromOnePlace) {
  const Evidence sound = Detections(Ring(4), {Swinging(20)}, 2.0);
  for (const std::size_t copies : {2u, 4u}) {
    Evidence copied = sound;
    for (std::size_t c = 0; c < copies; ++c) {
      copied.keypoint_views[c].camera.camera_from_world = sound.keypoint_views[0].camera.camera_from_world;
    }
    EXPECT_THAT(WhyRefused(copied), AllOf(HasSubstr(copies == 2 ? "cam1, cam2 stand" : "cam1, cam2, cam3, cam4 stand"),
                                          HasSubstr("is one file copied")));
  }
  Evidence twice = sound;
  twice.keypoint_views[3] = twice.keypoint_views[0];
  twice.keypoint_views[3].camera.name = "cam4";
  const auto found = TriangulatedSubject(twice);
  ASSERT_TRUE(found) << found.error().Message();
  const Finding* reported = FindingWithCode(*found, "cameras_in_one_place");
  ASSERT_NE(reported, nullptr);
  EXPECT_THAT(reported->message, AllOf(HasSubstr("cam1, cam4"), HasSubstr("given twice")));
  EXPECT_TRUE(found->report.suspect);
}

TEST(KeypointTracks, InterpolateFramesOfCamerasWhoseTimesDiffer) {
  // Fast arms; two cameras take their images half a frame later, with correct times.
  const Motion person = Swinging(60);
  Evidence evidence = Detections(Ring(4), {person}, 0.0);
  Evidence late = evidence;
  for (std::size_t c : {1, 3}) {
    KeypointView& view = late.keypoint_views[c];
    const KeypointView& given = evidence.keypoint_views[c];
    for (int f = 0; f + 1 < given.frames(); ++f) {
      view.time_s[f] += 0.5 / 30.0;
      for (std::size_t i = 0; i < 72; ++i) {
        const std::size_t at = static_cast<std::size_t>(f) * 72 + i;
        if (i % 3 != 2) view.values[at] = 0.5 * (given.values[at] + given.values[at + 72]);
      }
    }
    view.time_s.back() += 0.5 / 30.0;
  }
  const auto found = TriangulatedSubject(late);
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_LT(MeanError(found->tracks, person), 0.003);
  for (KeypointView& view : late.keypoint_views) view.time_s = evidence.keypoint_views[0].time_s;
  KeypointFitOptions as_stamped;
  as_stamped.audit.clocks = AuditAction::kOff;
  const auto wrong = TriangulateKeypoints(late, SmplBody(), as_stamped);
  ASSERT_TRUE(wrong) << wrong.error().Message();
  EXPECT_GT(MeanError(wrong->tracks, person), 2.0 * MeanError(found->tracks, person));
}

TEST(KeypointTracks, AreRefusedWithoutAPersonOrWithoutAgreement) {
  const Motion person = Swinging(10);
  const Evidence sound = Detections(Ring(4), {person}, 2.0);

  Evidence one = sound;
  one.keypoint_views.resize(1);
  EXPECT_THAT(WhyRefused(one), HasSubstr("1 camera give no depth"));

  EXPECT_THAT(WhyRefused(sound, 1), AllOf(HasSubstr("person 1 is requested"), HasSubstr("1 person")));

  Evidence empty = sound;
  for (KeypointView& view : empty.keypoint_views) std::fill(view.values.begin(), view.values.end(), 0.0);
  EXPECT_THAT(WhyRefused(empty), HasSubstr("no view shows a person"));

  Evidence later = sound;
  for (double& time : later.keypoint_views[1].time_s) time += 1000.0;
  for (std::size_t c : {2, 3}) later.keypoint_views[c].values = empty.keypoint_views[c].values;
  EXPECT_THAT(WhyRefused(later), HasSubstr("at the same time"));
}

TEST(KeypointTracks, AreRefusedOrSuspectWithExchangedFiles) {
  const Evidence sound = Detections(Ring(4), {Swinging(10)}, 2.0);
  Evidence exchanged = sound;
  for (std::size_t c = 0; c < 4; ++c) {
    exchanged.keypoint_views[c].values = sound.keypoint_views[(c + 1) % 4].values;
    for (std::size_t i = 1; i < exchanged.keypoint_views[c].values.size(); i += 3) {
      exchanged.keypoint_views[c].values[i] += 150.0 * static_cast<double>(c);
    }
  }
  const auto found = TriangulatedSubject(exchanged);
  if (found) {
    EXPECT_TRUE(found->report.suspect) << found->report.triangulated << " " << found->report.median_px;
  } else {
    EXPECT_THAT(found.error().Message(), HasSubstr("px"));
  }
}

TEST(KeypointTracks, AreRefusedWithAWrongCalibration) {
  const Motion person = Swinging(10);
  const Evidence sound = Detections(Ring(4), {person}, 2.0);

  Evidence millimetres = sound;
  for (KeypointView& view : millimetres.keypoint_views) view.camera.camera_from_world.translation *= 1000.0;
  EXPECT_THAT(WhyRefused(millimetres),
              AllOf(HasSubstr("times a person's size"), HasSubstr("millimetres read as metres")));

  Evidence behind = sound;  // the person is behind all cameras
  for (KeypointView& view : behind.keypoint_views) {
    const Vector3d centre = view.camera.Centre();
    RigidTransform& pose = view.camera.camera_from_world;
    pose.rotation = Quaterniond(0, 0, 1, 0) * pose.rotation;
    pose.translation = -(pose.rotation * centre);
    for (std::size_t i = 1; i < view.values.size(); i += 3) view.values[i] = 960.0 - view.values[i];
    view.camera.distortion = {};
  }
  EXPECT_THAT(WhyRefused(behind), HasSubstr("behind the cameras"));

  std::vector<Camera> line;  // one behind the other, all looking along the line
  for (int i = 0; i < 4; ++i) line.push_back(LookingAt("cam" + std::to_string(i), {0, 1.0, 4.0 + 0.2 * i}, {0, 1, 0}));
  EXPECT_THAT(WhyRefused(Detections(line, {person}, 2.0)), AllOf(HasSubstr("same line"), HasSubstr("degrees")));
}

TEST(KeypointTracks, AreRefusedWithKeypointsInAnotherOrder) {
  Evidence evidence = Detections(Ring(4), {Swinging(10)}, 2.0);
  std::rotate(evidence.keypoint_names.begin(), evidence.keypoint_names.begin() + 7, evidence.keypoint_names.end());
  EXPECT_THAT(WhyRefused(evidence), AllOf(HasSubstr("proportions"), HasSubstr("order")));
}

TEST(KeypointTracks, ReportViewsThatAreTooCloseToEachOther) {
  std::vector<Camera> close;
  for (int i = 0; i < 3; ++i) close.push_back(LookingAt("cam" + std::to_string(i), {0.25 * i, 1.2, 4.0}, {0, 1, 0}));
  const auto found = TriangulatedSubject(Detections(close, {Swinging(20)}, 0.5));
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_NE(FindingWithCode(*found, "views_close_together"), nullptr);
}

/// The recorded trials of Pose2Sim (README_multiview.md, sections 1 and 6).
class Pose2Sim : public testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("MOCURATE_DATA");
    if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
    folder_ = std::filesystem::path(data) / "pose2sim";
  }

  /// Median distance of two keypoints over the frames, metres.
  static double Length(const KeypointTracks& found, const std::string& a, const std::string& b) {
    const auto index = [&](const std::string& name) {
      const auto& names = found.report.keypoint_names;
      return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    };
    std::vector<double> lengths;
    for (int f = 0; f < found.tracks.positions.frames; ++f) {
      const std::size_t first = static_cast<std::size_t>(f) * found.tracks.positions.joints;
      if (found.tracks.confidence[first + index(a)] <= 0.0 || found.tracks.confidence[first + index(b)] <= 0.0)
        continue;
      lengths.push_back((found.tracks.positions.at(f, static_cast<int>(index(a))) -
                         found.tracks.positions.at(f, static_cast<int>(index(b))))
                            .norm());
    }
    return MeanMedian(lengths);
  }

  static void ExpectLimbs(const KeypointTracks& found, const std::vector<double>& table, double tolerance) {
    EXPECT_NEAR(Length(found, "right_hip", "right_knee"), table[0], tolerance);
    EXPECT_NEAR(Length(found, "left_hip", "left_knee"), table[1], tolerance);
    EXPECT_NEAR(Length(found, "right_knee", "right_ankle"), table[2], tolerance);
    EXPECT_NEAR(Length(found, "right_shoulder", "right_elbow"), table[3], tolerance);
    EXPECT_NEAR(Length(found, "right_elbow", "right_wrist"), table[4], tolerance);
    EXPECT_NEAR(Length(found, "left_shoulder", "right_shoulder"), table[5], tolerance);
  }

  const std::vector<double> adult_ = {0.412, 0.387, 0.397, 0.275, 0.251, 0.337};
  const std::vector<double> adult_of_two_ = {0.418, 0.399, 0.403, 0.268, 0.246, 0.333};  // of reference_3d_own_dlt.npz
  const std::vector<double> static_adult_ = {0.366, 0.365, 0.381, 0.274, 0.231, 0.397};
  const std::vector<double> child_ = {0.297, 0.297, 0.234, 0.199, 0.196, 0.263};  // likewise
  std::filesystem::path folder_;
};

TEST_F(Pose2Sim, FindsTheSubjectOfTheSingleTrialAmongBystanders) {
  const auto found = TriangulatedSubject(ReadPose2Sim(folder_, "single"));
  ASSERT_TRUE(found) << found.error().Message();
  const KeypointReport& report = found->report;
  EXPECT_LE(report.median_px, 8.5);
  EXPECT_LE(report.p90_px, 17.0);
  EXPECT_GE(report.triangulated, 0.79);
  double limbs = 0.0;
  for (std::size_t k = 5; k <= 18; ++k) limbs += k == 9 || k == 10 ? 0.0 : report.keypoint_share[k] / 12.0;
  EXPECT_GE(limbs, 0.97);
  EXPECT_EQ(report.seen_share, 1.0);
  const Finding* moved = FindingWithCode(*found, "camera_moved");
  ASSERT_NE(moved, nullptr);
  EXPECT_THAT(moved->message, HasSubstr("cam03"));
  EXPECT_EQ(moved->action, FindingAction::kRepaired);
  EXPECT_NE(FindingWithCode(*found, "bystanders_skipped"), nullptr);
  ExpectLimbs(*found, adult_, 0.01);
}

TEST_F(Pose2Sim, SeparatesBothPeopleInEveryFrame) {
  const Evidence evidence = ReadPose2Sim(folder_, "two");
  std::map<bool, int> times_found;
  for (const int subject : {0, 1}) {
    const auto found = TriangulatedSubject(evidence, subject);
    ASSERT_TRUE(found) << found.error().Message();
    EXPECT_EQ(found->report.seen_share, 1.0);
    const bool child = Length(*found, "right_knee", "right_ankle") < 0.33;
    ++times_found[child];
    ExpectLimbs(*found, child ? child_ : adult_of_two_, 0.011);
  }
  EXPECT_EQ(times_found[true], 1);
  EXPECT_EQ(times_found[false], 1);
}

TEST_F(Pose2Sim, AcceptsStaticTrials) {
  for (const auto& [trial, table] : {std::pair{"static_p1", static_adult_}, std::pair{"static_p2", child_}}) {
    const auto found = TriangulatedSubject(ReadPose2Sim(folder_, trial));
    ASSERT_TRUE(found) << trial << ": " << found.error().Message();
    EXPECT_LE(found->report.median_px, 9.0);
    EXPECT_TRUE(std::none_of(found->report.faults.begin(), found->report.faults.end(), [](const RigFault& fault) {
      return fault.code == "camera_moved";
    })) << "one frame twelve times does not show a moved camera";
    EXPECT_TRUE(std::any_of(found->findings.begin(), found->findings.end(),
                            [](const Finding& finding) { return finding.code == kRigNotAudited; }));
    if (trial == std::string("static_p1")) ExpectLimbs(*found, table, 0.012);
  }
}

TEST_F(Pose2Sim, RefusesKeypointsInTheOrderOfBody25) {
  Evidence evidence = ReadPose2Sim(folder_, "single", "BODY_25");
  EXPECT_THAT(WhyRefused(evidence), HasSubstr("proportions"));
}

}  // namespace
}  // namespace mocurate
