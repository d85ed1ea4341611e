#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "ingest/people/uestc.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

/// Frames [begin, end) of a person whose box starts at x and moves by `drift` pixels per frame.
VibeTrack TrackOfFrames(std::int64_t id, int begin, int end, double x, double drift = 0.0, double root_step = 0.1) {
  VibeTrack track;
  track.id = id;
  track.joints = 49;
  for (int f = begin; f < end; ++f) {
    ++track.frames;
    track.frame_ids.push_back(f);
    for (int j = 0; j < 24; ++j) {
      for (int axis = 0; axis < 3; ++axis)
        track.pose.push_back(j > 0 ? 0.01 * (j + axis) : axis == 1 ? root_step * f : 0.0);
    }
    for (int i = 0; i < 147; ++i) track.joints3d.push_back(0.01 * i + 0.001 * f);
    for (int i = 0; i < 10; ++i) track.betas.push_back(0.1 * i);
    track.original_camera.insert(track.original_camera.end(), {0.4, 0.7, 0.001 * f, 0.1});
    track.predicted_camera.insert(track.predicted_camera.end(), {0.8, 0.0, 0.0});
    track.boxes.insert(track.boxes.end(), {x + drift * (f - begin), 270.0, 80.0, 200.0});
  }
  return track;
}

UestcPerson Selected(const std::vector<VibeTrack>& tracks, double x, TrackRule rule) {
  auto person = SelectUestcTrack(tracks, {x, 270.0}, rule);
  if (!person) {
    ADD_FAILURE() << person.error().Message();
    return {};
  }
  return *std::move(person);
}

TEST(UestcTracks, SelectsASingleTrackAnywhereAndFillsItsGaps) {
  VibeTrack track = TrackOfFrames(3, 0, 10, 900);
  const VibeTrack later = TrackOfFrames(3, 14, 20, 900);
  track.frames += later.frames;
  for (auto field : {&VibeTrack::pose, &VibeTrack::joints3d, &VibeTrack::betas, &VibeTrack::original_camera,
                     &VibeTrack::predicted_camera, &VibeTrack::boxes}) {
    (track.*field).insert((track.*field).end(), (later.*field).begin(), (later.*field).end());
  }
  track.frame_ids.insert(track.frame_ids.end(), later.frame_ids.begin(), later.frame_ids.end());
  for (const TrackRule rule : {TrackRule::kUestcReleased, TrackRule::kUestcCorrected}) {
    const UestcPerson person = Selected({track}, 100, rule);
    EXPECT_THAT(person.chosen, ElementsAre(3));
    ASSERT_EQ(person.track.frames, 20u);
    for (std::size_t f = 0; f < 20; ++f) EXPECT_EQ(person.track.frame_ids[f], static_cast<std::int64_t>(f));
    EXPECT_EQ(person.interpolated[11], 1);
    EXPECT_EQ(person.interpolated[9], 0);
    EXPECT_NEAR(person.track.joints3d[11 * 147 + 5], 0.05 + 0.011, 1e-9) << "linear in time";
    ASSERT_EQ(person.findings.size(), 1u);
    EXPECT_EQ(person.findings[0].value, 4.0);
    if (rule == TrackRule::kUestcReleased) continue;
    EXPECT_NEAR(person.track.pose[11 * 72 + 1], 1.1, 1e-9);
  }
}

TEST(UestcTracks, SelectsTheTrackNearestToTheSensorPersonThenToTheLastPosition) {
  const std::vector<VibeTrack> tracks = {TrackOfFrames(1, 0, 100, 800), TrackOfFrames(2, 2, 50, 480, 2.0),
                                         TrackOfFrames(4, 55, 100, 580), TrackOfFrames(5, 53, 60, 120)};
  for (const TrackRule rule : {TrackRule::kUestcReleased, TrackRule::kUestcCorrected}) {
    EXPECT_THAT(Selected(tracks, 480, rule).chosen, ElementsAre(2, 4)) << "the person at 800 is in the background";
  }
}

TEST(UestcTracks, KeepsTheBeginningUnderTheCorrectedRuleOnly) {
  // The person is detected twice; the second detection is one pixel nearer.
  const std::vector<VibeTrack> tracks = {TrackOfFrames(1, 0, 60, 482), TrackOfFrames(2, 50, 100, 480)};
  EXPECT_THAT(Selected(tracks, 480, TrackRule::kUestcReleased).chosen, ElementsAre(2));
  const UestcPerson corrected = Selected(tracks, 480, TrackRule::kUestcCorrected);
  EXPECT_THAT(corrected.chosen, ElementsAre(1)) << "overlapping later tracks are dropped, as published";
  EXPECT_EQ(corrected.track.frame_ids.front(), 0);
}

TEST(UestcTracks, SelectsADistantPersonUnderThePublishedRuleOnly) {
  const std::vector<VibeTrack> tracks = {TrackOfFrames(1, 0, 50, 480), TrackOfFrames(2, 52, 60, 900),
                                         TrackOfFrames(3, 65, 90, 490)};
  EXPECT_THAT(Selected(tracks, 480, TrackRule::kUestcReleased).chosen, ElementsAre(1, 2, 3));
  const UestcPerson corrected = Selected(tracks, 480, TrackRule::kUestcCorrected);
  EXPECT_THAT(corrected.chosen, ElementsAre(1, 3));
  EXPECT_EQ(corrected.track.frames, 90u);
  EXPECT_EQ(corrected.findings.at(0).code, "other_person");
}

TEST(UestcTracks, ReproducesTheReversedRootRotationOfTheReleasedGapFilling) {
  // The root rotates from 3.0 to 3.3 rad, stored as 3.0 and -2.983. The negated vector is nearer in quaternion space.
  VibeTrack before = TrackOfFrames(1, 0, 2, 480), after = TrackOfFrames(2, 4, 6, 480);
  for (std::size_t f = 0; f < 2; ++f) before.pose[f * 72 + 1] = 3.0;
  for (std::size_t f = 0; f < 2; ++f) after.pose[f * 72 + 1] = 3.3 - 2.0 * 3.14159265358979;
  const UestcPerson corrected = Selected({before, after}, 480, TrackRule::kUestcCorrected);
  const Quaterniond truth = ExpQuaternion({0, 3.1, 0});
  const auto root = [](const UestcPerson& person, std::size_t f) {
    return ExpQuaternion({person.track.pose[f * 72], person.track.pose[f * 72 + 1], person.track.pose[f * 72 + 2]});
  };
  EXPECT_NEAR(AngleBetween(root(corrected, 2), truth), 0.0, 1e-9);
  const UestcPerson published = Selected({before, after}, 480, TrackRule::kUestcReleased);
  EXPECT_GT(AngleBetween(root(published, 3), ExpQuaternion({0, 3.2, 0})), 0.1)
      << "interpolated towards the inverse rotation";
}

TEST(UestcTracks, RejectsInconsistentTracks) {
  EXPECT_FALSE(SelectUestcTrack({}, {0, 0}, TrackRule::kUestcReleased));
  VibeTrack track = TrackOfFrames(1, 0, 5, 480);
  track.boxes.pop_back();
  const auto refused = SelectUestcTrack({track}, {0, 0}, TrackRule::kUestcReleased);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "bboxes");
}

TEST(UestcCamera, ComputesDepthFromTheScaleLikeTheReleasedHeightRatio) {
  Random random(5, "uestc", "");
  std::vector<double> camera;
  std::vector<double> released;
  for (int f = 0; f < 20; ++f) {
    const double sx = 0.2 + random.Uniform(), tx = random.Normal(), ty = random.Normal();
    camera.insert(camera.end(), {sx, 1.7 * sx, tx, ty});
    // 500 h3 / h2 over 49 joints: heights of the body in 3-D and in the image.
    double low[2][2] = {{1e9, 1e9}, {1e9, 1e9}}, high[2][2] = {{-1e9, -1e9}, {-1e9, -1e9}};
    for (int j = 0; j < 49; ++j) {
      for (int i = 0; i < 2; ++i) {
        const double value = random.Normal();
        const double pixel = (sx * (value + (i == 0 ? tx : ty)) + 1.0) * 270.0;
        low[0][i] = std::min(low[0][i], value), high[0][i] = std::max(high[0][i], value);
        low[1][i] = std::min(low[1][i], pixel), high[1][i] = std::max(high[1][i], pixel);
      }
    }
    const double h3 = std::hypot(high[0][0] - low[0][0], high[0][1] - low[0][1]);
    const double h2 = std::hypot(high[1][0] - low[1][0], high[1][1] - low[1][1]);
    released.push_back(500.0 * h3 / h2);
  }
  const auto translation = UestcTranslation(camera);
  ASSERT_TRUE(translation);
  for (std::size_t f = 0; f < 20; ++f) {
    EXPECT_NEAR((*translation)[f].z(), released[f] - released[0], 1e-9);
    EXPECT_NEAR((*translation)[f].x(), camera[4 * f + 2] - camera[2], 1e-12);
  }
  EXPECT_FALSE(UestcTranslation({0.0, 0.0, 0.0, 0.0}));
}

TEST(UestcCamera, RotatesSecondSideViewsByMultiplesOf45Degrees) {
  EXPECT_TRUE(UestcWorldFromView(5, 1).isIdentity(1e-12));
  const Vector3d rotated = UestcWorldFromView(2, 2) * Vector3d(1, 0, 0);
  EXPECT_TRUE(rotated.isApprox(Vector3d(0, 0, 1), 1e-12)) << rotated.transpose();
}

}  // namespace
}  // namespace mocurate
