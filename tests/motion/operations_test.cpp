#include "core/motion/operations.h"

#include <gmock/gmock.h>

#include "tests/motion/builders.h"

namespace mocurate {
namespace {

using test::Built;
using test::FullClip;
using test::LargestAngle;
using test::LargestDistance;
using testing::HasSubstr;

void ExpectSameClip(const Clip& a, const Clip& b, double tolerance) {
  EXPECT_EQ(a.id(), b.id());
  EXPECT_TRUE(a.rate == b.rate);
  ASSERT_TRUE(a.motion && b.motion);
  EXPECT_LE(LargestDistance(a.motion->joints, b.motion->joints), tolerance);
  EXPECT_LE(LargestAngle(*a.motion, *b.motion), tolerance == 0 ? 1e-7 : 10 * tolerance);
  EXPECT_EQ(a.motion->state, b.motion->state);
  EXPECT_EQ(a.motion->contact, b.motion->contact);
  EXPECT_EQ(a.motion->rotation_sigma, b.motion->rotation_sigma);
  EXPECT_EQ(a.motion->rotation_observed, b.motion->rotation_observed);
  ASSERT_EQ(a.motion->position_cov.size(), b.motion->position_cov.size());
  for (std::size_t i = 0; i < a.motion->position_cov.size(); ++i) {
    EXPECT_NEAR(a.motion->position_cov[i], b.motion->position_cov[i], 1e-9);
  }
  EXPECT_EQ(a.evidence.tracks->names, b.evidence.tracks->names);
  EXPECT_LE(LargestDistance(a.evidence.tracks->positions, b.evidence.tracks->positions), tolerance);
  EXPECT_EQ(a.evidence.tracks->confidence, b.evidence.tracks->confidence);
  EXPECT_EQ(a.evidence.tracks->time_s.size(), b.evidence.tracks->time_s.size());
  EXPECT_EQ(a.evidence.tracks->rotation_confidence, b.evidence.tracks->rotation_confidence);
  ASSERT_EQ(a.evidence.tracks->rotation.size(), b.evidence.tracks->rotation.size());
  for (std::size_t i = 0; i < a.evidence.tracks->rotation.size(); ++i)
    EXPECT_LE(a.evidence.tracks->rotation[i].angularDistance(b.evidence.tracks->rotation[i]), tolerance + 1e-7);
  EXPECT_EQ(a.evidence.depth_views[0].files, b.evidence.depth_views[0].files);
  EXPECT_EQ(a.evidence.depth_views[0].sha256, b.evidence.depth_views[0].sha256);
  EXPECT_EQ(a.evidence.clouds->files, b.evidence.clouds->files);
  EXPECT_EQ(a.evidence.keypoint_names, b.evidence.keypoint_names);
  EXPECT_EQ(a.evidence.keypoint_views[0].values, b.evidence.keypoint_views[0].values);
  EXPECT_TRUE(CheckKeypoints(b.evidence));
  ASSERT_EQ(a.segments.size(), b.segments.size());
  for (std::size_t i = 0; i < a.segments.size(); ++i) {
    EXPECT_NEAR(a.segments[i].begin_s, b.segments[i].begin_s, 1e-12);
    EXPECT_NEAR(a.segments[i].end_s, b.segments[i].end_s, 1e-12);
  }
}

TEST(Cut, TwoCutsAreOneCut) {
  const Clip clip = FullClip("smpl24", 40);
  const Clip twice = Cut(Cut(clip, 5, 35).value(), 10, 20).value();
  const Clip once = Cut(clip, 15, 25).value();
  EXPECT_EQ(once.id(), "set/s01/take#115-125");
  ExpectSameClip(once, twice, 0.0);
}

TEST(Cut, TakesTheSpanOutOfEveryField) {
  const Clip clip = FullClip("openni16", 40);
  const Clip cut = Cut(clip, 25, 35).value();
  EXPECT_TRUE(cut.motion->Check()) << cut.motion->Check().error().Message();
  EXPECT_EQ(cut.motion->frame_count(), 10);
  EXPECT_EQ(cut.motion->joints.at(0, 3), clip.motion->joints.at(25, 3));
  EXPECT_EQ(cut.motion->contact.size(), 20u);
  EXPECT_EQ(cut.evidence.tracks->positions.frames, 10);
  EXPECT_EQ(cut.evidence.tracks->time_s.front(), 0.0);
  EXPECT_EQ(cut.evidence.depth_views[0].files.front(), "depth_25.png");
  EXPECT_EQ(cut.evidence.depth_views[0].sha256.size(), 10u);
  EXPECT_EQ(cut.evidence.clouds->files.front(), "cloud_25.ply");
  EXPECT_EQ(cut.evidence.clouds->sha256.back(), "sha_34");
  EXPECT_EQ(cut.evidence.clouds->time_s.front(), 0.0);
  EXPECT_EQ(cut.evidence.keypoint_views[0].frames(), 10);
  EXPECT_EQ(cut.evidence.keypoint_views[0].at(0, 1, 2)[1], 25.0);
  ASSERT_EQ(cut.segments.size(), 1u) << "the walk ends before the span";
  EXPECT_EQ(cut.segments[0].label, "wave");
  EXPECT_NEAR(cut.segments[0].begin_s, 0.0, 1e-12);
  EXPECT_NEAR(cut.segments[0].end_s, 10.0 / 30.0, 1e-12);
}

TEST(Cut, EvidenceAtAnotherRateIsCutByTime) {
  Clip clip = FullClip("openni16", 40);
  Clip fast = FullClip("openni16", 80, {60, 1});
  clip.evidence = fast.evidence;
  const Clip cut = Cut(clip, 10, 20).value();
  EXPECT_EQ(cut.evidence.tracks->positions.frames, 20);
  EXPECT_EQ(cut.evidence.depth_views[0].files.front(), "depth_20.png");
  EXPECT_NEAR(cut.evidence.tracks->time_s[1], 1.0 / 60.0, 1e-12);
}

TEST(Cut, KeepsWhatIsBetweenTheClocksOfItsViews) {
  for (const bool by_motion : {true, false}) {
    for (const double lag : {0.011, -0.004, 0.2}) {
      SCOPED_TRACE(lag);
      Clip clip = FullClip("openni16", 40);
      if (!by_motion) clip.motion.reset();
      Evidence& evidence = clip.evidence;
      evidence.depth_views.push_back(evidence.depth_views.front());
      for (double& time : evidence.tracks->time_s) time += 7.0;
      for (double& time : evidence.depth_views[0].time_s) time += 7.0;
      for (double& time : evidence.depth_views[1].time_s) time += 7.0 + lag;
      const Evidence cut = Cut(clip, 10, 20).value().evidence;
      ASSERT_EQ(cut.depth_views[1].time_s.size(), 10u);
      EXPECT_NEAR(cut.tracks->time_s.front(), 0.0, 1e-12);
      EXPECT_NEAR(cut.depth_views[0].time_s.front(), 0.0, 1e-12);
      EXPECT_NEAR(cut.depth_views[1].time_s.front(), lag, 1e-12);
    }
  }
}

TEST(Cut, AViewThatBeginsLaterIsCutAtTheSameMoment) {
  Clip clip = FullClip("openni16", 40);
  DepthView late = clip.evidence.depth_views.front();
  late.files.erase(late.files.begin(), late.files.begin() + 5);
  late.sha256.erase(late.sha256.begin(), late.sha256.begin() + 5);
  late.time_s.erase(late.time_s.begin(), late.time_s.begin() + 5);
  clip.evidence.depth_views.push_back(late);
  const Evidence cut = Cut(clip, 10, 20).value().evidence;
  EXPECT_EQ(cut.depth_views[1].files, cut.depth_views[0].files);
  for (std::size_t f = 0; f < cut.depth_views[0].time_s.size(); ++f) {
    EXPECT_NEAR(cut.depth_views[1].time_s[f], cut.depth_views[0].time_s[f], 1e-12);
  }
}

TEST(Cut, AnEmptySpanAndOneOutsideAreRefused) {
  const Clip clip = FullClip("openni16", 10);
  for (const auto& [begin, end] : {std::pair(3, 3), std::pair(-1, 4), std::pair(5, 11), std::pair(6, 5)}) {
    const auto cut = Cut(clip, begin, end);
    ASSERT_FALSE(cut);
    EXPECT_EQ(cut.error().code, ErrorCode::kUsage);
    EXPECT_THAT(cut.error().Message(), HasSubstr("10 frames"));
  }
}

TEST(Resample, ToTheSameRateChangesNothing) {
  const Clip clip = FullClip("smpl24", 20);
  const Clip same = Resample(clip, {60, 2});
  ExpectSameClip(clip, same, 0.0);
  for (std::size_t i = 0; i < clip.motion->rotation.size(); ++i) {
    EXPECT_EQ(clip.motion->rotation[i].coeffs(), same.motion->rotation[i].coeffs());
  }
}

TEST(Resample, DoubledAndHalvedIsTheSameMotion) {
  const Clip clip = FullClip("smpl24", 21);
  const Clip doubled = Resample(clip, {60, 1});
  EXPECT_EQ(doubled.motion->frame_count(), 41);
  EXPECT_EQ(doubled.evidence.tracks->positions.frames, 41);
  EXPECT_EQ(doubled.evidence.keypoint_views[0].frames(), 41);
  EXPECT_EQ(doubled.evidence.keypoint_views[0].at(40, 1, 2)[1], 20.0);
  EXPECT_TRUE(CheckKeypoints(doubled.evidence));
  EXPECT_EQ(doubled.evidence.clouds->files[40], "cloud_20.ply");
  EXPECT_EQ(doubled.evidence.clouds->time_s, doubled.evidence.depth_views[0].time_s);
  EXPECT_TRUE(doubled.motion->Check()) << doubled.motion->Check().error().Message();
  EXPECT_LT(LargestDistance(Resample(doubled, {30, 1}).motion->joints, clip.motion->joints), 1e-12);
}

TEST(Resample, EndsWithTheLastFrameInside) {
  const Clip clip = FullClip("openni16", 100, {120000, 1001});
  const Clip slow = Resample(clip, {30, 1});
  const double last = clip.motion->rate.FrameTime(99);
  const int count = slow.motion->frame_count();
  EXPECT_LE(slow.motion->rate.FrameTime(count - 1), last);
  EXPECT_GT(slow.motion->rate.FrameTime(count), last);
}

TEST(Resample, AMissingNeighbourLeavesAMissingObservation) {
  Clip clip = FullClip("openni16", 10);
  clip.evidence.tracks->confidence[16 * 4] = 0.0;
  clip.evidence.tracks->positions.at(4, 0).setConstant(1e6);
  const Clip doubled = Resample(clip, {60, 1});
  for (const int frame : {7, 8, 9}) EXPECT_EQ(doubled.evidence.tracks->confidence[16 * frame], 0.0) << frame;
  for (const int frame : {6, 10}) EXPECT_EQ(doubled.evidence.tracks->confidence[16 * frame], 1.0) << frame;
}

TEST(ResampleToCount, KeepsFirstAndLast) {
  const Motion motion = test::SwingingPerson(Built("openni16"), 37);
  for (const int count : {2, 37, 60}) {
    const Motion taken = ResampleToCount(motion, count);
    ASSERT_EQ(taken.frame_count(), count);
    EXPECT_TRUE(taken.Check()) << taken.Check().error().Message();
    EXPECT_LT((taken.joints.at(0, 8) - motion.joints.at(0, 8)).norm(), 1e-12);
    EXPECT_LT((taken.joints.at(count - 1, 8) - motion.joints.at(36, 8)).norm(), 1e-12);
  }
}

TEST(Transform, MovesEverythingThatHasAPlace) {
  const Clip before = FullClip("smpl24", 6);
  Clip after = before;
  const RigidTransform move{ExpQuaternion(Vector3d(0.3, -1.2, 0.5)), Vector3d(1, -2, 0.5)};
  Transform(move, after);
  EXPECT_TRUE(after.motion->Check()) << after.motion->Check().error().Message();
  const Vector3d hand = before.motion->joints.at(3, 20);
  EXPECT_LT((after.motion->joints.at(3, 20) - move * hand).norm(), 1e-12);
  EXPECT_LT((after.evidence.tracks->positions.at(3, 20) - move * hand).norm(), 1e-12);
  const Quaterniond& turned = after.evidence.tracks->rotation[3 * 24 + 20];
  EXPECT_LT(turned.angularDistance(move.rotation * before.evidence.tracks->rotation[3 * 24 + 20]), 1e-12);
  const Vector2d pixel = before.evidence.depth_views[0].camera.ProjectWorld(hand).value();
  EXPECT_LT((after.evidence.depth_views[0].camera.ProjectWorld(move * hand).value() - pixel).norm(), 1e-9);
  const auto seen = after.evidence.keypoint_views[0].camera.ProjectWorld(move * hand).value();
  EXPECT_LT((seen - pixel).norm(), 1e-9) << "a detection keeps its pixel position";
  const Vector3d in_file(300, -200, 100);
  const auto placed = [&](const Clip& clip) {
    const CloudFiles& clouds = *clip.evidence.clouds;
    return Vector3d(clouds.world_from_file * Vector3d(clouds.metres_per_unit * in_file));
  };
  EXPECT_LT((placed(after) - move * placed(before)).norm(), 1e-12);
  const Vector3d source(4, 5, 6);
  EXPECT_LT((after.canonical_from_source * source - move * (before.canonical_from_source * source)).norm(), 1e-12);
  Transform(Inverse(move), after);
  ExpectSameClip(before, after, 1e-7);
}

TEST(Resample, KeepsCountingInFramesOfTheRecordingWhenCut) {
  for (const double hz : {59.94005994, 120.0, 250.0}) {
    const FrameRate recorded = FrameRate::FromHz(hz);
    Clip clip;
    clip.identity = {"s", "p", "r", "", "", "", 0, 22003};
    clip.rate = recorded;
    clip.motion = MakeJointsOnly(Built("smpl24"), recorded, JointPositions(22003, Built("smpl24")->joint_count()));
    const auto cut = Cut(Resample(clip, FrameRate{20, 1}), 1600, 1700);
    ASSERT_TRUE(cut) << cut.error().Message();
    EXPECT_EQ(cut->identity.begin_frame, std::lround(80.0 * recorded.hz()));
    EXPECT_EQ(cut->identity.end_frame, std::lround(85.0 * recorded.hz()));
    EXPECT_TRUE(RecordedRate(*cut) == recorded);
  }
}

}  // namespace
}  // namespace mocurate
