// Cameras with lens distortion.
#include "core/geometry/camera.h"

#include "tests/geometry/samples.h"

namespace mocurate {
namespace {

using test::Difference;
using test::DrawRotation;
using test::DrawVector;

Camera SportsHallCamera() {
  Camera camera;
  camera.name = "hall";
  camera.width = 1088;
  camera.height = 1920;
  camera.fx = 1681.2;
  camera.fy = 1679.1;
  camera.cx = 532.9;
  camera.cy = 948.1;
  camera.distortion = {-0.046183, 0.139983, 0.000608, 0.00069, 0.0};
  return camera;
}

Camera WideCamera() {
  Camera camera = SportsHallCamera();
  camera.width = 640;
  camera.height = 480;
  camera.fx = 520.0;
  camera.fy = 525.0;
  camera.cx = 321.5;
  camera.cy = 236.8;
  camera.distortion = {-0.28, 0.09, 0.001, -0.0007, -0.012};
  return camera;
}

TEST(Camera, FollowsTheOpenCvModel) {
  Camera camera;
  camera.fx = camera.fy = 1.0;
  const Vector3d point(0.2, 0.4, 2.0);  // normalised (0.1, 0.2), r2 = 0.05
  EXPECT_LT(Difference(camera.Project(point).value(), Vector2d(0.1, 0.2)), 1e-16);
  camera.distortion = {1.0, 0, 0, 0, 0};
  EXPECT_LT(Difference(camera.Project(point).value(), Vector2d(0.105, 0.21)), 4e-15);
  camera.distortion = {0, 10.0, 0, 0, 0};
  EXPECT_LT(Difference(camera.Project(point).value(), Vector2d(0.1025, 0.205)), 4e-15);
  camera.distortion = {0, 0, 1.0, 0, 0};  // 2 x y, r2 + 2 y^2
  EXPECT_LT(Difference(camera.Project(point).value(), Vector2d(0.14, 0.33)), 4e-15);
  camera.distortion = {0, 0, 0, 1.0, 0};  // r2 + 2 x^2, 2 x y
  EXPECT_LT(Difference(camera.Project(point).value(), Vector2d(0.17, 0.24)), 4e-15);
  camera.distortion = {0, 0, 0, 0, 8.0};  // 1 + 8 * 0.000125
  EXPECT_LT(Difference(camera.Project(point).value(), Vector2d(0.1001, 0.2002)), 4e-15);
}

TEST(Camera, SeesNothingBehindItself) {
  const Camera camera = SportsHallCamera();
  EXPECT_FALSE(camera.Project(Vector3d(0.1, 0.1, -1.0)).has_value());
  EXPECT_FALSE(camera.Project(Vector3d(0.1, 0.1, 0.0)).has_value());
  EXPECT_TRUE(camera.Project(Vector3d(0.1, 0.1, 1e-3)).has_value());
}

TEST(Camera, UnprojectsEveryPixelOntoItself) {
  for (const Camera& camera : {SportsHallCamera(), WideCamera()}) {
    for (int y = 0; y < camera.height; y += 60) {
      for (int x = 0; x < camera.width; x += 60) {
        const Vector2d pixel(x, y);
        const Vector3d point = camera.Unproject(pixel, 2.5);
        EXPECT_EQ(point.z(), 2.5);
        EXPECT_LT(Difference(camera.Project(point).value(), pixel), 1e-9) << x << ' ' << y;
      }
    }
  }
}

TEST(Camera, UnprojectsTheImageOfAPointToThePoint) {
  const Camera camera = WideCamera();
  for (double x = -0.8; x <= 0.8; x += 0.1) {
    for (double y = -0.8; y <= 0.8; y += 0.1) {
      const Vector3d point = 3.0 * Vector3d(x, y, 1.0);
      EXPECT_LT(Difference(camera.Unproject(camera.Project(point).value(), 3.0), point), 1e-10) << x << ' ' << y;
    }
  }
}

TEST(Camera, GivesFiniteRaysBeyondTheReachOfItsDistortion) {
  Camera camera = WideCamera();
  camera.distortion = {-0.5, 0, 0, 0, 0};  // radii beyond 0.816 fold back
  for (const Vector2d& pixel : {Vector2d(-5000, 900), Vector2d(9000, 9000)}) {
    EXPECT_TRUE(camera.Unproject(pixel, 1.0).allFinite());
  }
}

TEST(Camera, ProjectsWorldPointsThroughItsPlace) {
  Random random(40, "camera");
  Camera camera = SportsHallCamera();
  for (int i = 0; i < 50; ++i) {
    camera.camera_from_world = {DrawRotation(random), DrawVector(random)};
    EXPECT_LT((camera.camera_from_world * camera.Centre()).norm(), 1e-14);
    const Vector3d in_camera(0.3 * random.Normal(), 0.3 * random.Normal(), 4.0);
    const Vector3d in_world = Inverse(camera.camera_from_world) * in_camera;
    EXPECT_LT(Difference(camera.ProjectWorld(in_world).value(), camera.Project(in_camera).value()), 1e-10);
  }
}

}  // namespace
}  // namespace mocurate
