#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/camera.h"
#include "core/geometry/rotation.h"

namespace mocurate {

/// A body at rest: skin and joints, metres, y up, facing +z, T-pose.
struct RestBody {
  std::vector<Vector3d> vertices;  ///< (V)
  std::vector<Vector3d> joints;    ///< (J)
};

/// Adds `coefficient` times a shape direction.
void AddShape(double coefficient, const RestBody& direction, RestBody& body);

/// Joints of a posed body in the world: rotations and positions (J).
struct PosedJoints {
  std::vector<Matrix3d> rotation;
  std::vector<Vector3d> position;
};

/// G_j = G_parent [R_j | J_j - J_parent] of joints `rest` (J), joint 0 at `root`. `parent_of(j)`: -1 for joint 0,
/// parents precede children; `rotation` (J) local.
template <class ParentOf>
PosedJoints PoseJoints(const std::vector<Vector3d>& rest, const ParentOf& parent_of, const Quaterniond* rotation,
                       const Vector3d& root) {
  PosedJoints posed;
  for (std::size_t j = 0; j < rest.size(); ++j) {
    const Matrix3d own = rotation[j].toRotationMatrix();
    const int parent = parent_of(j);
    const auto p = static_cast<std::size_t>(parent < 0 ? 0 : parent);
    posed.rotation.push_back(parent < 0 ? own : Matrix3d(posed.rotation[p] * own));
    posed.position.push_back(parent < 0 ? root : Vector3d(posed.position[p] + posed.rotation[p] * (rest[j] - rest[p])));
  }
  return posed;
}

/// A rigged body mesh with shape directions: v = v_template + sum of b_k * direction_k, joints likewise.
struct BodyTemplate {
  std::vector<std::string> joint_names;           ///< (J)
  std::vector<int> parents;                       ///< (J); -1 for joint 0, parents precede children
  std::vector<std::array<int, 3>> faces;          ///< counter-clockwise seen from outside
  RestBody rest;                                  ///< the template itself
  std::vector<std::array<int, 4>> weight_joints;  ///< (V) joints that move a vertex
  std::vector<std::array<double, 4>> weights;     ///< (V) sum to 1
  std::vector<std::string> shape_names;           ///< (S)
  std::vector<RestBody> shape_directions;         ///< (S)
  std::map<std::string, RestBody> variants;       ///< "male", "female", "child": whole bodies, feet at y = 0

  int joint_count() const { return static_cast<int>(parents.size()); }

  /// Every rule above. Error kInconsistent that names the field.
  Status Check() const;
};

/// The body of shape coefficients (S, or fewer: the others are 0).
RestBody Shaped(const BodyTemplate& body, const std::vector<double>& coefficients);

/// Linear blend skinning: G_j = G_parent [R_j | J_j - J_parent], v' = sum of w_j (G_j,rot (v - J_j) + G_j,trans), then
/// `translation`. Rotations are local, one per joint. Vertices and joints in the world, metres.
RestBody Posed(const BodyTemplate& body, const RestBody& rest, const std::vector<Quaterniond>& rotations,
               const Vector3d& translation);

/// Depth of a triangle mesh by a z-buffer: metres along the camera's z axis, 0 where nothing is hit; row-major,
/// (height*width). `vertices` in the world; `rays` of PixelRays. A pixel is covered when its centre lies in the
/// triangle's image; depth is that of the triangle's plane on the pixel's ray, exact also with lens distortion. Both
/// sides of a triangle are drawn; triangles with a corner nearer than `near` metres are not.
std::vector<float> RenderMesh(const std::vector<Vector3d>& vertices, const std::vector<std::array<int, 3>>& faces,
                              const Camera& camera, const std::vector<Vector2d>& rays, double near = 0.05);

}  // namespace mocurate
