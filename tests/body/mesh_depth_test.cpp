// Depth images of triangle meshes.
#include "core/body/skinned_body.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/body/bone_capsules.h"

namespace mocurate {
namespace {

struct Mesh {
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> faces;
};

/// A ball of rings and sectors, its vertices on the sphere.
Mesh Ball(const Vector3d& centre, double radius, int rings, int sectors) {
  constexpr double kHalfTurn = 3.14159265358979323846;
  Mesh mesh;
  for (int r = 0; r <= rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      const double up = kHalfTurn * r / rings, around = 2.0 * kHalfTurn * s / sectors;
      mesh.vertices.push_back(
          centre + radius * Vector3d(std::sin(up) * std::cos(around), std::cos(up), std::sin(up) * std::sin(around)));
    }
  }
  const auto at = [&](int r, int s) { return r * sectors + s % sectors; };
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      mesh.faces.push_back({at(r, s), at(r + 1, s), at(r, s + 1)});
      mesh.faces.push_back({at(r, s + 1), at(r + 1, s), at(r + 1, s + 1)});
    }
  }
  return mesh;
}

Camera Pinhole() {
  Camera camera;
  camera.width = 160;
  camera.height = 120;
  camera.fx = camera.fy = 150.0;
  camera.cx = 79.5;
  camera.cy = 59.5;
  return camera;
}

/// Largest difference where both see something; pixels that only one sees are counted.
double Compare(const std::vector<float>& mesh, const std::vector<float>& exact, int& seen, int& differing) {
  double most = 0.0;
  seen = differing = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    if ((mesh[i] > 0.0F) != (exact[i] > 0.0F)) ++differing;
    if (mesh[i] == 0.0F || exact[i] == 0.0F) continue;
    ++seen;
    most = std::max(most, std::abs(static_cast<double>(mesh[i]) - exact[i]));
  }
  return most;
}

std::vector<float> ExactBall(const Vector3d& centre, double radius, const Camera& camera) {
  return RenderCapsules({{centre, centre, radius}}, camera, PixelRays(camera)).depth;
}

TEST(MeshDepth, AFineBallIsABall) {
  const Camera camera = Pinhole();
  const Vector3d centre(0.1, -0.05, 2.0);
  const Mesh ball = Ball(centre, 0.4, 90, 180);
  int seen = 0, differing = 0;
  const auto depth = RenderMesh(ball.vertices, ball.faces, camera, PixelRays(camera));
  const double most = Compare(depth, ExactBall(centre, 0.4, camera), seen, differing);
  EXPECT_GT(seen, 2500);
  EXPECT_LT(differing, seen / 100) << "only along the outline, where the mesh lies inside the ball";
  EXPECT_LT(most, 0.02) << "at the outline the surface is viewed edge-on";
}

TEST(MeshDepth, ALensBendsTheOutlineAndNotTheDepth) {
  Camera camera = Pinhole();
  camera.distortion = {-0.2, 0.24, -0.001, -0.001, 0.0};
  const Vector3d centre(0.25, 0.15, 1.6);
  const Mesh ball = Ball(centre, 0.35, 120, 240);
  int seen = 0, differing = 0;
  const auto depth = RenderMesh(ball.vertices, ball.faces, camera, PixelRays(camera));
  EXPECT_LT(Compare(depth, ExactBall(centre, 0.35, camera), seen, differing), 0.02);
  EXPECT_LT(differing, seen / 50);
}

TEST(MeshDepth, TheNearerTriangleIsVisibleInAnyOrder) {
  const Camera camera = Pinhole();
  const std::vector<Vector3d> vertices = {{-1, -1, 3}, {1, -1, 3}, {0, 1, 3}, {-1, -1, 2}, {1, -1, 2}, {0, 1, 2}};
  const auto rays = PixelRays(camera);
  const auto far_first = RenderMesh(vertices, {{0, 1, 2}, {3, 4, 5}}, camera, rays);
  const auto near_first = RenderMesh(vertices, {{3, 4, 5}, {0, 1, 2}}, camera, rays);
  EXPECT_EQ(far_first, near_first);
  EXPECT_FLOAT_EQ(far_first[60 * 160 + 80], 2.0F);
}

TEST(MeshDepth, TwoTrianglesThatShareAnEdgeLeaveNoGapAndNothingIsDrawnBehindTheCamera) {
  const Camera camera = Pinhole();
  const std::vector<Vector3d> square = {{-0.5, -0.3, 2}, {0.5, -0.3, 2}, {0.5, 0.3, 2}, {-0.5, 0.3, 2}};
  const auto rays = PixelRays(camera);
  const auto depth = RenderMesh(square, {{0, 1, 2}, {0, 2, 3}}, camera, rays);
  for (int y = 40; y < 80; ++y) {
    for (int x = 45; x < 115; ++x) EXPECT_FLOAT_EQ(depth[static_cast<std::size_t>(y) * 160 + x], 2.0F) << x << " " << y;
  }
  std::vector<Vector3d> behind = square;
  for (Vector3d& vertex : behind) vertex.z() = -2.0;
  for (const float value : RenderMesh(behind, {{0, 1, 2}, {0, 2, 3}}, camera, rays)) EXPECT_EQ(value, 0.0F);
}

}  // namespace
}  // namespace mocurate
