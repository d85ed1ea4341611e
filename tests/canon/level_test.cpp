// The floor is estimated from standing feet for any tilt of the sensor.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include "canon/frames/level.h"
#include "core/base/pi.h"
#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

constexpr double kDegree = kPi / 180.0;

/// People who stand for a second each, `away` metres around the origin, rotated by `spread` radians around +z, leaning
/// forward by about two degrees; joints with noise of 1 cm.
std::vector<Clip> StandingPeople(int count, double away, double spread) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  std::vector<Clip> clips;
  for (int k = 0; k < count; ++k) {
    Random random(3, "standing", std::to_string(k));
    const Quaterniond heading(Eigen::AngleAxisd(random.Uniform(-spread, spread), Vector3d::UnitY()));
    const Quaterniond lean(Eigen::AngleAxisd(random.Uniform(0.5, 3.5) * kDegree, Vector3d::UnitX()));
    const Vector3d place(random.Uniform(-away, away), 0.95, random.Uniform(-away, away));
    constexpr int kFrames = 30;
    std::vector<Quaterniond> rotation(static_cast<std::size_t>(kFrames * skeleton->joint_count()),
                                      Quaterniond::Identity());
    for (int f = 0; f < kFrames; ++f) rotation[static_cast<std::size_t>(f * skeleton->joint_count())] = heading * lean;
    Motion motion = MakeMotion(skeleton, FrameRate{30, 1}, std::vector<Vector3d>(kFrames, place), rotation,
                               skeleton->RestBoneLengths());
    double lowest = 10.0;
    for (const int foot : {10, 11}) lowest = std::min(lowest, motion.joints.at(0, foot).y());
    const Vector3d noise(0.01 * random.Normal(), 0.01 * random.Normal() - lowest, 0.01 * random.Normal());
    for (int f = 0; f < kFrames; ++f) {
      for (int j = 0; j < motion.joint_count(); ++j) motion.joints.at(f, j) += noise;
    }
    Clip clip;
    clip.motion = MakeJointsOnly(skeleton, motion.rate, motion.joints);
    clips.push_back(std::move(clip));
  }
  return clips;
}

std::vector<Motion> SeenBy(const RigidTransform& sensor_from_world, std::vector<Clip> clips) {
  std::vector<Motion> motions;
  for (Clip& clip : clips) {
    Transform(sensor_from_world, clip);
    motions.push_back(*clip.motion);
  }
  return motions;
}

LevelOptions Tilts() {
  LevelOptions options;
  options.rule = FloorRule::kTilt;
  return options;
}

TEST(Floor, UnderATiltedSensorIsFoundAndLevelled) {
  const std::vector<Clip> people = StandingPeople(40, 1.0, kPi);
  for (const double degrees : {0.0, 4.0, 9.0, 15.0, 25.0}) {
    for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0.6, 0, 0.8)}) {
      const RigidTransform sensor{Quaterniond(Eigen::AngleAxisd(degrees * kDegree, axis)), Vector3d(0.1, -0.8, -2.5)};
      const auto floor = EstimateFloor(Tilts(), SeenBy(sensor, people));
      ASSERT_TRUE(floor);
      EXPECT_NEAR(floor->tilt() / kDegree, degrees, 1.0);
      EXPECT_LT(floor->tilt_sigma, 1.0 * kDegree);
      Clip clip = people[0];
      Transform(sensor, clip);
      LevelClip(*floor, clip);
      double lowest = 10.0;
      for (const int foot : {10, 11}) lowest = std::min(lowest, clip.motion->joints.at(0, foot).y());
      EXPECT_NEAR(lowest, 0.0, 0.06);
      EXPECT_EQ(clip.provenance.count("level.tilt_deg"), 1u);
    }
  }
}

TEST(Floor, SaysHowLittleItKnowsWherePeopleStandInOnePlaceAndFaceOneWay) {
  const RigidTransform sensor{Quaterniond(Eigen::AngleAxisd(0.1, Vector3d::UnitX())), Vector3d(0, -1, -2)};
  const auto here = EstimateFloor(Tilts(), SeenBy(sensor, StandingPeople(20, 0.02, 0.05)));
  const auto around = EstimateFloor(Tilts(), SeenBy(sensor, StandingPeople(20, 1.0, kPi)));
  ASSERT_TRUE(here && around);
  EXPECT_GT(here->tilt_sigma, 2.0 * around->tilt_sigma);
}

TEST(Floor, ByHeightAloneKeepsTheVertical) {
  LevelOptions options;
  options.rule = FloorRule::kHeight;
  const RigidTransform sensor{Quaterniond::Identity(), Vector3d(0, -0.7, -2)};
  const auto floor = EstimateFloor(options, SeenBy(sensor, StandingPeople(10, 0.5, kPi)));
  ASSERT_TRUE(floor);
  EXPECT_EQ(floor->up, Vector3d::UnitY());
  EXPECT_NEAR(floor->height, -0.7, 0.02);
  const FloorPlane again = nlohmann::json(*floor).get<FloorPlane>();
  EXPECT_NEAR(again.height, floor->height, 1e-12);
}

TEST(Floor, OfNoPersonIsUnknown) { EXPECT_FALSE(EstimateFloor(Tilts(), {})); }

}  // namespace
}  // namespace mocurate
