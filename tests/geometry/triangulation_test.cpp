#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "tests/support/linear_triangulation.h"
#include "tests/support/point_grid.h"

namespace mocurate {
namespace {

/// A ring of cameras that look at a point.
std::vector<Camera> Ring(int count, const Vector3d& target) {
  std::vector<Camera> cameras;
  for (int i = 0; i < count; ++i) {
    Camera camera;
    camera.fx = camera.fy = 1000, camera.cx = 960, camera.cy = 540;
    camera.width = 1920, camera.height = 1080;
    camera.distortion = {-0.1, 0.02, 0.001, -0.002, 0.0};
    camera.camera_from_world.rotation = ExpQuaternion(Vector3d(0.2, 0, 0)) * ExpQuaternion(Vector3d(0, 1.1 * i, 0));
    camera.camera_from_world.translation = Vector3d(0, 0, 4) - camera.camera_from_world.rotation * target;
    cameras.push_back(camera);
  }
  return cameras;
}

std::vector<ImageObservation> Sight(const std::vector<Camera>& cameras, const Vector3d& point) {
  std::vector<ImageObservation> sightings;
  for (const Camera& camera : cameras) sightings.push_back({&camera, *camera.ProjectWorld(point), 1.0});
  return sightings;
}

TEST(TriangulateLinear, FindsThePointThroughLensDistortionWhereverTheWorldsOriginIs) {
  Random random(3, "triangulation");
  for (const double far : {0.0, 10.0, 1e5}) {
    const Vector3d target = Vector3d::Constant(far);
    for (int n = 2; n <= 6; ++n) {
      const std::vector<Camera> cameras = Ring(n, target);
      const Vector3d point = target + 0.5 * Vector3d(random.Normal(), random.Normal(), random.Normal());
      const auto found = TriangulateLinear(Sight(cameras, point));
      ASSERT_TRUE(found);
      EXPECT_LT((*found - point).norm(), far > 1e4 ? 1e-8 : 1e-10);
    }
  }
}

TEST(TriangulateLinear, DoesNotReadAViewWithoutWeight) {
  const std::vector<Camera> cameras = Ring(4, Vector3d::Zero());
  std::vector<ImageObservation> sightings = Sight(cameras, Vector3d(0.1, 0.2, 0.3));
  sightings[2].pixel = Vector2d(1e6, std::nan(""));
  sightings[2].weight = 0.0;
  EXPECT_LT((*TriangulateLinear(sightings) - Vector3d(0.1, 0.2, 0.3)).norm(), 1e-10);
  sightings[1].pixel.x() += 50.0;
  const double off = (*TriangulateLinear(sightings) - Vector3d(0.1, 0.2, 0.3)).norm();
  sightings[1].weight = 0.1;
  EXPECT_LT((*TriangulateLinear(sightings) - Vector3d(0.1, 0.2, 0.3)).norm(), 0.2 * off);
}

TEST(TriangulateLinear, NeedsTwoRaysThatAreNotParallel) {
  const std::vector<Camera> cameras = Ring(2, Vector3d::Zero());
  std::vector<ImageObservation> sightings = Sight(cameras, Vector3d(0, 0.1, 0));
  sightings[1].weight = 0.0;
  EXPECT_FALSE(TriangulateLinear(sightings));
  sightings[1] = sightings[0];
  EXPECT_FALSE(TriangulateLinear(sightings));
  EXPECT_FALSE(TriangulateLinear({}));
  Camera beside = cameras[0];
  beside.camera_from_world.translation.x() -= 1.0;
  EXPECT_FALSE(TriangulateLinear({{&cameras[0], Vector2d(960, 540), 1.0}, {&beside, Vector2d(960, 540), 1.0}}));
}

TEST(NearestPointToAxes, LiesWhereTheOpticalAxesMeet) {
  const Vector3d target(1, 2, 3);
  std::vector<RigidTransform> poses;
  for (const Camera& camera : Ring(4, target)) poses.push_back(camera.camera_from_world);
  const auto meeting = NearestPointToAxes(poses);
  ASSERT_TRUE(meeting);
  EXPECT_LT((meeting->point - target).norm(), 1e-12);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(meeting->depth[i], 4.0, 1e-12);
    EXPECT_NEAR(meeting->miss[i], 0.0, 1e-12);
  }
  EXPECT_FALSE(NearestPointToAxes({RigidTransform{}, {Quaterniond::Identity(), Vector3d(1, 0, 0)}}));
}

TEST(BackProject, GivesTheMeasuredPixelsOfTheMaskInOrder) {
  const DepthImage depth{3, 2, {0, 1000, 2000, 500, 0, 700}};
  const PixelMask mask{3, 2, {1, 1, 0, 1, 1, 1}};
  Camera camera;
  camera.fx = camera.fy = 2, camera.cx = 1, camera.cy = 0;
  const std::vector<Vector3d> points = BackProject(depth, camera, 0.001, &mask);
  ASSERT_EQ(points.size(), 3u);
  EXPECT_LT((points[0] - Vector3d(0, 0, 1)).norm(), 1e-15);
  EXPECT_LT((points[1] - Vector3d(-0.25, 0.25, 0.5)).norm(), 1e-15);
  EXPECT_LT((points[2] - Vector3d(0.35, 0.35, 0.7)).norm(), 1e-15);
  EXPECT_EQ(BackProject(depth, camera, 0.001).size(), 4u);
  const PixelMask other{2, 3, {1, 1, 1, 1, 1, 1}};
  EXPECT_TRUE(BackProject(depth, camera, 0.001, &other).empty());
}

TEST(PointGrid, FindsTheNearestPointWithinReach) {
  Random random(5, "grid");
  std::vector<Vector3d> points;
  for (int i = 0; i < 400; ++i)
    points.emplace_back(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1));
  for (const double cell : {0.03, 0.2, 5.0}) {
    const PointGrid grid(points, cell);
    for (int i = 0; i < 200; ++i) {
      const Vector3d query(random.Uniform(-1.5, 1.5), random.Uniform(-1.5, 1.5), random.Uniform(-1.5, 1.5));
      const double reach = random.Uniform(0.05, 0.8);
      int best = -1;
      double distance = reach;
      for (int k = 0; k < 400; ++k) {
        if ((points[k] - query).norm() < distance) best = k, distance = (points[k] - query).norm();
      }
      ASSERT_EQ(grid.Nearest(query, reach), best);
      EXPECT_DOUBLE_EQ(grid.Distance(query, reach), distance);
    }
  }
}

}  // namespace
}  // namespace mocurate
