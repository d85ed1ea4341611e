// Depth images of posed capsules.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/body/bone_capsules.h"
#include "tests/body/stick_figure.h"
#include "tests/support/render_depth.h"

namespace mocurate {
namespace {

/// In front of the figure at z = 2.5 m, half way up, looking at it (world y up, camera y down).
Camera FrontCamera() {
  Camera camera;
  camera.width = 160;
  camera.height = 120;
  camera.fx = camera.fy = 140.0;
  camera.cx = 79.5;
  camera.cy = 59.5;
  const Quaterniond turn(Eigen::AngleAxisd(3.14159265358979323846, Vector3d::UnitX()));
  camera.camera_from_world.rotation = turn;
  camera.camera_from_world.translation = -(turn * Vector3d(0, 0.4, 2.5));
  return camera;
}

/// Where a ray enters the body, by stepping along it by the signed distance.
double March(const BoneCapsules& body, const Vector3d* joints, const Camera& camera, const Vector2d& ray) {
  const RigidTransform world_from_camera = Inverse(camera.camera_from_world);
  const Vector3d direction = Vector3d(ray.x(), ray.y(), 1.0);
  double depth = 0.0;
  for (int step = 0; step < 4000 && depth < 10.0; ++step) {
    const double distance =
        ClosestOnBody(body, joints, world_from_camera * Vector3d(depth * direction))->on_capsule.distance;
    if (distance < 1e-10) return depth;
    depth += distance / direction.norm();
  }
  return 0.0;
}

int CompareWithMarching(const BoneCapsules& body, const Vector3d* joints, const Camera& camera) {
  const std::vector<Vector2d> rays = PixelRays(camera);
  const DepthRendering rendering = RenderBody(body, joints, camera, rays);
  int seen = 0;
  int grazing = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const double expected = March(body, joints, camera, rays[i]);
    if ((expected > 0.0) != (rendering.depth[i] > 0.0F)) {
      ++grazing;  // a ray along the outline, within rounding
      continue;
    }
    EXPECT_NEAR(rendering.depth[i], expected, 1e-5) << i;
    EXPECT_EQ(rendering.depth[i] > 0.0F, rendering.capsule[i] >= 0);
    seen += rendering.depth[i] > 0.0F ? 1 : 0;
  }
  EXPECT_LE(grazing, 2);
  return seen;
}

TEST(DepthRendering, EqualsMarchingAlongEveryRay) {
  const test::StickFigure figure = test::MakeStickFigure();
  const BoneCapsules body = BoneCapsules::Make(figure.skeleton);
  EXPECT_GT(CompareWithMarching(body, figure.joints.data(), FrontCamera()), 500);
}

TEST(DepthRendering, EqualsMarchingFromAnyPlaceWithLensDistortion) {
  const test::StickFigure figure = test::MakeStickFigure();
  const BoneCapsules body = BoneCapsules::Make(figure.skeleton);
  Random random(5, "cameras");
  int seen = 0;
  for (int i = 0; i < 6; ++i) {
    Camera camera = FrontCamera();
    camera.width = 80;
    camera.height = 60;
    camera.fx = camera.fy = 60.0;
    camera.cx = 40.0;
    camera.cy = 30.0;
    if (i % 2 == 1) camera.distortion = {-0.2, 0.05, 0.001, -0.002, 0.0};
    const Vector3d nudge(random.Normal(), random.Normal(), random.Normal());
    camera.camera_from_world.rotation = ExpQuaternion(0.2 * nudge) * camera.camera_from_world.rotation;
    camera.camera_from_world.translation =
        -(camera.camera_from_world.rotation * Vector3d(0.3 * random.Normal(), 0.4, random.Uniform(0.3, 2.0)));
    seen += CompareWithMarching(body, figure.joints.data(), camera);
  }
  EXPECT_GT(seen, 2000);
}

TEST(DepthRendering, SeesTheFrontOfTheTrunkAtItsDistance) {
  const test::StickFigure figure = test::MakeStickFigure();
  Camera camera = FrontCamera();
  camera.cx = 80.0;
  camera.cy = 60.0;
  const std::vector<float> depth = RenderDepth(BoneCapsules::Make(figure.skeleton), figure.joints.data(), camera);
  ASSERT_EQ(depth.size(), 160u * 120u);
  EXPECT_NEAR(depth[60 * 160 + 80], 2.5 - 0.12, 1e-6);
  EXPECT_EQ(depth[0], 0.0F);
  // The left hand (+x) of a figure that faces the camera is on the right of the picture.
  const std::size_t row = static_cast<std::size_t>(std::lround(60 - 0.2 / 2.5 * 140)) * 160;
  EXPECT_NEAR(depth[row + 80 + static_cast<int>(0.4 / 2.5 * 140)], 2.46, 2e-3);
}

TEST(DepthRendering, OfAMirroredPictureIsThePictureMirrored) {
  const test::StickFigure figure = test::MakeStickFigure();
  const BoneCapsules body = BoneCapsules::Make(figure.skeleton);
  Camera camera = FrontCamera();
  const std::vector<float> depth = RenderDepth(body, figure.joints.data(), camera);
  camera.fx = -camera.fx;  // as Kinects write their images; the centre is the middle column
  const std::vector<float> mirrored = RenderDepth(body, figure.joints.data(), camera);
  int seen = 0;
  for (std::size_t y = 0; y < 120; ++y) {
    for (std::size_t x = 0; x < 160; ++x) {
      EXPECT_NEAR(mirrored[y * 160 + x], depth[y * 160 + 159 - x], 1e-5);
      seen += depth[y * 160 + x] > 0.0F ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 500);
}

TEST(DepthRendering, BackProjectsOntoTheSurface) {
  const test::StickFigure figure = test::MakeStickFigure();
  const BoneCapsules body = BoneCapsules::Make(figure.skeleton);
  const Camera camera = FrontCamera();
  const RigidTransform world_from_camera = Inverse(camera.camera_from_world);
  const std::vector<float> depth = RenderDepth(body, figure.joints.data(), camera);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const float here = depth[static_cast<std::size_t>(y) * camera.width + x];
      if (here == 0.0F) continue;
      const Vector3d point = world_from_camera * camera.Unproject(Vector2d(x, y), here);
      EXPECT_NEAR(ClosestOnBody(body, figure.joints.data(), point)->on_capsule.distance, 0.0, 1e-6);
    }
  }
}

TEST(DepthRendering, DrawsNothingBehindTheCameraNorAroundIt) {
  const test::StickFigure figure = test::MakeStickFigure();
  const BoneCapsules body = BoneCapsules::Make(figure.skeleton);
  Camera away = FrontCamera();
  away.camera_from_world.rotation = Quaterniond::Identity();  // looks along +z
  away.camera_from_world.translation = -Vector3d(0, 0.4, 2.5);
  Camera inside = FrontCamera();
  inside.camera_from_world.translation = -(inside.camera_from_world.rotation * Vector3d(0, 0.3, 0));
  const DepthRendering from_inside = RenderBody(body, figure.joints.data(), inside, PixelRays(inside));
  EXPECT_EQ(std::count(from_inside.capsule.begin(), from_inside.capsule.end(), 0), 0);
  for (const float depth : RenderDepth(body, figure.joints.data(), away)) EXPECT_EQ(depth, 0.0F);
}

}  // namespace
}  // namespace mocurate
