#include "fitting/association/body_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/median.h"

namespace mocurate {
std::vector<KnownLength> KnownLengths(const std::vector<std::string>& names, const Skeleton& skeleton) {
  std::vector<int> keypoint_of_joint(skeleton.joints.size(), -1);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::optional<int> joint = skeleton.FindJoint(names[k]);
    if (joint && keypoint_of_joint[static_cast<std::size_t>(*joint)] < 0) {
      keypoint_of_joint[static_cast<std::size_t>(*joint)] = static_cast<int>(k);
    }
  }
  std::vector<KnownLength> lengths;
  const auto add = [&](int a, int b, double rest) {
    const int from = keypoint_of_joint[static_cast<std::size_t>(a)];
    const int to = keypoint_of_joint[static_cast<std::size_t>(b)];
    if (from < 0 || to < 0 || rest < kShortestKnownBone) return;
    lengths.push_back(
        {from, to, rest, names[static_cast<std::size_t>(from)] + " to " + names[static_cast<std::size_t>(to)]});
  };
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    const Joint& joint = skeleton.joints[static_cast<std::size_t>(j)];
    if (joint.mirror != j) add(joint.parent, j, joint.rest_offset.norm());
  }
  const std::vector<std::optional<std::array<int, 2>>> pairs = {skeleton.Hips(), skeleton.Shoulders()};
  for (const auto& pair : pairs) {
    if (!pair) continue;
    std::array<Vector3d, 2> place{Vector3d::Zero(), Vector3d::Zero()};
    for (std::size_t side = 0; side < 2; ++side) {
      for (int j = (*pair)[side]; j > 0; j = skeleton.joints[static_cast<std::size_t>(j)].parent) {
        place[side] += skeleton.joints[static_cast<std::size_t>(j)].rest_offset;
      }
    }
    add((*pair)[0], (*pair)[1], (place[0] - place[1]).norm());
  }
  return lengths;
}

std::vector<double> MeasureLengths(const BodyPoints& body, const std::vector<KnownLength>& lengths) {
  std::vector<double> measured;
  measured.reserve(lengths.size());
  for (const KnownLength& length : lengths) {
    const auto from = static_cast<std::size_t>(length.from);
    const auto to = static_cast<std::size_t>(length.to);
    const bool known = body.known[from] != 0 && body.known[to] != 0;
    measured.push_back(known ? (body.position[from] - body.position[to]).norm() : 0.0);
  }
  return measured;
}

ShapeMatch CompareShape(const std::vector<double>& measured, const std::vector<KnownLength>& lengths) {
  std::vector<double> logs;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (measured[i] > 0.0) logs.push_back(std::log(measured[i] / lengths[i].rest));
  }
  ShapeMatch match;
  match.lengths = static_cast<int>(logs.size());
  if (logs.empty()) return match;
  const double middle = MeanMedian(logs);
  match.scale = std::exp(middle);
  for (const double value : logs) match.mismatch += std::min(std::abs(value - middle), 1.0) / match.lengths;
  return match;
}

ShapeMatch CompareShape(const BodyPoints& body, const std::vector<KnownLength>& lengths) {
  return CompareShape(MeasureLengths(body, lengths), lengths);
}

}  // namespace mocurate
