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

RestBody Shaped(const BodyTemplate& body, const std::vector<double>& coefficients) {
  RestBody shaped = body.rest;
  for (std::size_t s = 0; s < std::min(coefficients.size(), body.shape_directions.size()); ++s) {
    const RestBody& direction = body.shape_directions[s];
    for (std::size_t v = 0; v < shaped.vertices.size(); ++v)
      shaped.vertices[v] += coefficients[s] * direction.vertices[v];
    for (std::size_t j = 0; j < shaped.joints.size(); ++j) shaped.joints[j] += coefficients[s] * direction.joints[j];
  }
  return shaped;
}

RestBody Posed(const BodyTemplate& body, const RestBody& rest, const std::vector<Quaterniond>& rotations,
               const Vector3d& translation) {
  RestBody posed;
  std::vector<Matrix3d> turned;
  for (std::size_t j = 0; j < body.parents.size(); ++j) {
    const Matrix3d own = rotations[j].toRotationMatrix();
    if (body.parents[j] < 0) {
      turned.push_back(own);
      posed.joints.push_back(rest.joints[j] + translation);
      continue;
    }
    const auto parent = static_cast<std::size_t>(body.parents[j]);
    turned.push_back(turned[parent] * own);
    posed.joints.push_back(posed.joints[parent] + turned[parent] * (rest.joints[j] - rest.joints[parent]));
  }
  posed.vertices.reserve(rest.vertices.size());
  for (std::size_t v = 0; v < rest.vertices.size(); ++v) {
    Vector3d vertex = Vector3d::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      const auto joint = static_cast<std::size_t>(body.weight_joints[v][k]);
      if (body.weights[v][k] == 0.0) continue;
      vertex += body.weights[v][k] * (turned[joint] * (rest.vertices[v] - rest.joints[joint]) + posed.joints[joint]);
    }
    posed.vertices.push_back(vertex);
  }
  return posed;
}

}  // namespace mocurate
