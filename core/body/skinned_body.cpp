#include "core/body/skinned_body.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace mocurate {
namespace {

constexpr double kWeightTolerance = 1e-4;

Status Bad(const std::string& field, const std::string& rule) { return Fail(ErrorCode::kInconsistent, rule, field); }

bool Fits(const RestBody& body, std::size_t vertices, std::size_t joints) {
  return body.vertices.size() == vertices && body.joints.size() == joints;
}

/// A triangle in the camera's frame and its image.
struct SeenTriangle {
  std::array<Vector3d, 3> corner;
  std::array<Vector2d, 3> pixel;
};

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Whether pixels on an edge are part of the triangle: each edge of a closed mesh is drawn by one of its two sides.
bool OwnsEdge(const Vector2d& edge) { return edge.y() > 0.0 || (edge.y() == 0.0 && edge.x() < 0.0); }

void Draw(const SeenTriangle& triangle, const Camera& camera, const std::vector<Vector2d>& rays,
          std::vector<float>& depth) {
  const auto& [a, b, c] = triangle.pixel;
  const double area = Cross(b - a, c - a);
  if (area == 0.0 || !std::isfinite(area)) return;
  const double sign = area > 0.0 ? 1.0 : -1.0;
  const auto span = [](double low, double high, int size) {
    const double first = std::clamp(std::ceil(low), 0.0, static_cast<double>(size));
    const double last = std::clamp(std::floor(high) + 1.0, first, static_cast<double>(size));
    return std::pair<int, int>(static_cast<int>(first), static_cast<int>(last));
  };
  const auto [left, right] = span(std::min({a.x(), b.x(), c.x()}), std::max({a.x(), b.x(), c.x()}), camera.width);
  const auto [top, bottom] = span(std::min({a.y(), b.y(), c.y()}), std::max({a.y(), b.y(), c.y()}), camera.height);
  const Vector3d normal = (triangle.corner[1] - triangle.corner[0]).cross(triangle.corner[2] - triangle.corner[0]);
  const double offset = normal.dot(triangle.corner[0]);
  const std::array<Vector2d, 3> edge = {sign * (b - a), sign * (c - b), sign * (a - c)};
  const double nearest = std::min({triangle.corner[0].z(), triangle.corner[1].z(), triangle.corner[2].z()});
  const double farthest = std::max({triangle.corner[0].z(), triangle.corner[1].z(), triangle.corner[2].z()});
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      const Vector2d at(x, y);
      bool inside = true;
      for (std::size_t k = 0; k < 3 && inside; ++k) {
        const double side = Cross(edge[k], at - triangle.pixel[k]);
        inside = side > 0.0 || (side == 0.0 && OwnsEdge(edge[k]));
      }
      if (!inside) continue;
      const std::size_t pixel = static_cast<std::size_t>(y) * camera.width + x;
      const double along = normal.dot(Vector3d(rays[pixel].x(), rays[pixel].y(), 1.0));
      // A triangle viewed edge-on has no unique depth on the ray; its nearest corner's is used.
      const double z = along == 0.0 ? nearest : std::clamp(offset / along, nearest, farthest);
      const auto value = static_cast<float>(z);
      if (depth[pixel] == 0.0F || value < depth[pixel]) depth[pixel] = value;
    }
  }
}

}  // namespace

Status BodyTemplate::Check() const {
  const std::size_t vertices = rest.vertices.size();
  const std::size_t joints = parents.size();
  if (vertices == 0 || joints == 0) return Bad("v_template", "a body has vertices and joints");
  if (joint_names.size() != joints) return Bad("joint_names", "there must be one name per joint");
  if (!Fits(rest, vertices, joints)) return Bad("J_template", "there must be one position per joint");
  for (std::size_t j = 0; j < joints; ++j) {
    const bool root = j == 0;
    if (root ? parents[j] != -1 : parents[j] < 0 || parents[j] >= static_cast<int>(j)) {
      return Bad("parents/" + std::to_string(j), "joint 0 is the root and parents precede their children");
    }
  }
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (const int corner : faces[f]) {
      if (corner < 0 || corner >= static_cast<int>(vertices)) {
        return Bad("faces/" + std::to_string(f), "there is no vertex " + std::to_string(corner));
      }
    }
  }
  if (weights.size() != vertices || weight_joints.size() != vertices)
    return Bad("weights", "one row per vertex is needed");
  for (std::size_t v = 0; v < vertices; ++v) {
    double sum = 0.0;
    for (std::size_t k = 0; k < 4; ++k) {
      if (weight_joints[v][k] < 0 || weight_joints[v][k] >= static_cast<int>(joints) || weights[v][k] < 0.0) {
        return Bad("weights/" + std::to_string(v), "a weight is negative or is not of any joint");
      }
      sum += weights[v][k];
    }
    if (std::abs(sum - 1.0) > kWeightTolerance)
      return Bad("weights/" + std::to_string(v), "the weights do not sum to 1");
  }
  if (shape_names.size() != shape_directions.size())
    return Bad("shape_names", "one name per shape direction is needed");
  for (const RestBody& direction : shape_directions) {
    if (!Fits(direction, vertices, joints)) return Bad("shapedirs", "a direction does not fit the template");
  }
  for (const auto& [name, variant] : variants) {
    if (!Fits(variant, vertices, joints)) return Bad("variants/" + name, "the variant does not fit the template");
  }
  return {};
}

void AddShape(double coefficient, const RestBody& direction, RestBody& body) {
  for (std::size_t v = 0; v < body.vertices.size(); ++v) body.vertices[v] += coefficient * direction.vertices[v];
  for (std::size_t j = 0; j < body.joints.size(); ++j) body.joints[j] += coefficient * direction.joints[j];
}

RestBody Shaped(const BodyTemplate& body, const std::vector<double>& coefficients) {
  RestBody shaped = body.rest;
  for (std::size_t s = 0; s < std::min(coefficients.size(), body.shape_directions.size()); ++s) {
    AddShape(coefficients[s], body.shape_directions[s], shaped);
  }
  return shaped;
}

RestBody Posed(const BodyTemplate& body, const RestBody& rest, const std::vector<Quaterniond>& rotations,
               const Vector3d& translation) {
  const PosedJoints posed = PoseJoints(
      rest.joints, [&](std::size_t j) { return body.parents[j]; }, rotations.data(),
      Vector3d(rest.joints[0] + translation));
  std::vector<Vector3d> vertices;
  vertices.reserve(rest.vertices.size());
  for (std::size_t v = 0; v < rest.vertices.size(); ++v) {
    Vector3d vertex = Vector3d::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      const auto joint = static_cast<std::size_t>(body.weight_joints[v][k]);
      if (body.weights[v][k] == 0.0) continue;
      vertex += body.weights[v][k] *
                (posed.rotation[joint] * (rest.vertices[v] - rest.joints[joint]) + posed.position[joint]);
    }
    vertices.push_back(vertex);
  }
  return {std::move(vertices), posed.position};
}

std::vector<float> RenderMesh(const std::vector<Vector3d>& vertices, const std::vector<std::array<int, 3>>& faces,
                              const Camera& camera, const std::vector<Vector2d>& rays, double near) {
  std::vector<float> depth(rays.size(), 0.0F);
  std::vector<Vector3d> in_camera;
  std::vector<std::optional<Vector2d>> pixel;
  in_camera.reserve(vertices.size());
  pixel.reserve(vertices.size());
  for (const Vector3d& vertex : vertices) {
    in_camera.push_back(camera.camera_from_world * vertex);
    pixel.push_back(in_camera.back().z() > near ? camera.Project(in_camera.back()) : std::nullopt);
  }
  for (const std::array<int, 3>& face : faces) {
    SeenTriangle triangle;
    bool in_front = true;
    for (std::size_t k = 0; k < 3 && in_front; ++k) {
      const auto corner = static_cast<std::size_t>(face[k]);
      in_front = pixel[corner].has_value();
      if (!in_front) continue;
      triangle.corner[k] = in_camera[corner];
      triangle.pixel[k] = *pixel[corner];
    }
    if (in_front) Draw(triangle, camera, rays, depth);
  }
  return depth;
}

}  // namespace mocurate
