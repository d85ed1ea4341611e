// The floor is estimated from standing feet for any tilt of the sensor.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "canon/frames/facing.h"
#include "canon/frames/level.h"
#include "core/base/config.h"
#include "core/base/pi.h"
#include "core/base/random.h"
#include "core/base/resources.h"
#include "core/motion/gaps.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "core/quality/contacts.h"
#include "tests/ingest/sources.h"

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

/// Every `step`-th clip of a source, joints on a skeleton where it has tracks.
std::vector<Clip> RecordedClips(const std::string& source, const std::string& skeleton, std::size_t step) {
  std::vector<Clip> clips;
  const auto discovery = Discover(Declared(source));
  if (!discovery) ADD_FAILURE() << discovery.error().Message();
  for (std::size_t i = 0; discovery && i < discovery->items.size(); i += step) {
    Ingested ingested = RunIngest(discovery->items[i], "floor_" + source);
    if (!ingested.outcome) continue;
    Clip clip = std::move(ingested.clip);
    if (!clip.motion) {
      auto motion = MotionFromTracks(*clip.evidence.tracks, *LoadSkeleton(skeleton), clip.rate, kMaxGap_s);
      if (!motion) continue;
      clip.motion = std::move(*motion);
    }
    clip.evidence = Evidence();
    clips.push_back(std::move(clip));
  }
  return clips;
}

/// Height of the feet at rest: the median over all stance phases.
double MedianFootHeight(const std::vector<Clip>& clips) {
  std::vector<double> heights;
  for (const Clip& clip : clips) {
    for (const int foot : FootJoints(*clip.motion->skeleton)) {
      const std::vector<bool> stands = JointContacts(*clip.motion, foot, {});
      for (int f = 0; f < clip.motion->frame_count(); ++f) {
        if (stands[static_cast<std::size_t>(f)]) heights.push_back(clip.motion->joints.at(f, foot).y());
      }
    }
  }
  if (heights.empty()) return 10.0;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  return *middle;
}

TEST(Floor, OfRecordedSetsIsHeightZeroByDefault) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  struct Set {
    const char* source;
    const char* skeleton;
    std::size_t step;
  };
  for (const auto& [source, skeleton, step] : {Set{"kard", "openni15", 9}, Set{"bandai2", "bandai22", 10}}) {
    SCOPED_TRACE(source);
    std::vector<Clip> clips = RecordedClips(source, skeleton, step);
    ASSERT_GE(clips.size(), 12u);
    std::vector<Motion> motions;
    for (const Clip& clip : clips) motions.push_back(*clip.motion);
    LevelOptions options;
    options.rule = FloorRule::kHeight;
    const auto floor = EstimateFloor(options, motions);
    ASSERT_TRUE(floor);
    std::vector<Clip> rooted = clips;
    for (Clip& clip : clips) {
      LevelClip(*floor, clip);
      ASSERT_TRUE(FaceFront({}, clip));
      EXPECT_EQ(clip.provenance.at(kHeightOrigin), kOriginFloor);
      EXPECT_LT(std::hypot(clip.motion->joints.at(0, 0).x(), clip.motion->joints.at(0, 0).z()), 1e-9);
    }
    EXPECT_NEAR(MedianFootHeight(clips), 0.0, 0.015);
    for (Clip& clip : rooted) ASSERT_TRUE(FaceFront({}, clip));
    EXPECT_LT(MedianFootHeight(rooted), -0.6) << "without a floor the root is at height 0";
  }
}

/// Datasets of jobs, recipes and papers are root-centred, whatever is the default.
TEST(Floor, IsNotHeightZeroInAnyJobOfThePapers) {
  const bool unset = std::getenv("MOCURATE_DATA") == nullptr;
  if (unset) ::setenv("MOCURATE_DATA", "data", 1);  // the jobs refer to it
  int jobs = 0;
  for (const std::string& path : ResourcePaths()) {
    const std::string folder = path.substr(0, path.rfind('/') + 1);
    const bool paper = folder.rfind("papers/", 0) == 0;
    if (!paper && folder != "" && folder != "reannotate/" && folder != "recipes/") continue;
    const auto node = LoadConfig(ConfigSource{std::string(*FindResource(path)), "resource:" + path, {}});
    ASSERT_TRUE(node) << path << node.error().Message();
    const ConfigNode* canon = node->Find("canon");
    if (paper && canon == nullptr) continue;  // its sets are those of a job
    const ConfigNode* facing = canon == nullptr ? nullptr : canon->Find("facing");
    const ConfigNode* height = facing == nullptr ? nullptr : facing->Find("height");
    ASSERT_NE(height, nullptr) << path;
    EXPECT_EQ(height->scalar, "root") << path;
    ++jobs;
  }
  EXPECT_GE(jobs, 45);
  if (unset) ::unsetenv("MOCURATE_DATA");
}

TEST(Floor, OfNoPersonIsUnknown) { EXPECT_FALSE(EstimateFloor(Tilts(), {})); }

}  // namespace
}  // namespace mocurate
