#include "core/body/skinned_body.h"

#include <algorithm>
#include <cmath>

namespace mocurate {
namespace {

constexpr double kWeightTolerance = 1e-4;

Status Bad(const std::string& field, const std::string& rule) { return Fail(ErrorCode::kInconsistent, rule, field); }

bool Fits(const RestBody& body, std::size_t vertices, std::size_t joints) {
  return body.vertices.size() == vertices && body.joints.size() == joints;
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

}  // namespace mocurate
