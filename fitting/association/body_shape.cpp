#include "fitting/association/body_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "core/base/median.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kSmallestRigPerson = 0.4;  ///< share of the rest pose's size; a toddler has 0.45
constexpr double kLargestRigPerson = 1.6;   ///< share of the rest pose's size, at most
/// Log ratio, absolute, mean over the lengths: beyond, the proportions are no person's; people have up to 0.15.
constexpr double kImplausible = 0.3;
constexpr int kLengthsToDiagnose = 4;  ///< lengths that a diagnosis needs

}  // namespace

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

std::vector<double> MedianLengths(const JointPositions& points, const std::vector<double>& confidence,
                                  const std::vector<KnownLength>& lengths, const std::vector<int>& frames) {
  std::vector<double> medians;
  for (const KnownLength& length : lengths) {
    std::vector<double> samples;
    for (const int f : frames) {
      const std::size_t first = static_cast<std::size_t>(f) * points.joints;
      if (confidence[first + length.from] <= 0.0 || confidence[first + length.to] <= 0.0) continue;
      samples.push_back((points.at(f, length.from) - points.at(f, length.to)).norm());
    }
    medians.push_back(MeanMedian(samples));
  }
  return medians;
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

std::optional<UnitMisreading> FindUnit(double scale) {
  if (scale >= kSmallestRigPerson && scale <= kLargestRigPerson) return {};
  /// Factor of the measured size for each wrong unit (numerical).
  constexpr std::pair<double, const char*> kUnits[] = {
      {1000.0, "millimetres read as metres"},    {100.0, "centimetres read as metres"},
      {39.37, "inches read as metres"},          {3.281, "feet read as metres"},
      {10.0, "millimetres read as centimetres"}, {0.1, "centimetres read as millimetres"},
      {0.01, "metres read as centimetres"},      {0.001, "metres read as millimetres"}};
  std::optional<UnitMisreading> unit;
  double nearest = std::log(1.6);
  for (const auto& [factor, text] : kUnits) {
    const double off = std::abs(std::log(scale / factor));
    if (off >= nearest) continue;
    nearest = off;
    unit = {factor, text};
  }
  return unit;
}

Status CheckPersonShape(const std::vector<double>& measured, const std::vector<KnownLength>& lengths) {
  const ShapeMatch shape = CompareShape(measured, lengths);
  if (shape.lengths < kLengthsToDiagnose) return {};
  std::size_t worst = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (measured[i] <= 0.0) continue;
    const double off = std::abs(std::log(measured[i] / (shape.scale * lengths[i].rest)));
    if (off > most) worst = i, most = off;
  }
  if (shape.mismatch > kImplausible) {
    return Fail(
        ErrorCode::kInconsistent,
        "the limbs have implausible proportions: " + lengths[worst].name + " is " + RoundedText(measured[worst], 3) +
            " m, the other lengths predict " + RoundedText(shape.scale * lengths[worst].rest, 3) +
            " m; mean deviation by a factor of " + RoundedText(std::exp(shape.mismatch), 3),
        "keypoints", "check that the keypoint names have the detector's order (BODY_25, BODY_25B, COCO_17 ...)");
  }
  if (shape.scale >= kSmallestRigPerson && shape.scale <= kLargestRigPerson) return {};
  const auto unit = FindUnit(shape.scale);
  return Fail(ErrorCode::kInconsistent,
              "the person would be " + RoundedText(shape.scale, 3) + " times a person's size (" + lengths[worst].name +
                  " " + RoundedText(measured[worst], 3) + " m)",
              "keypoints",
              unit ? "the calibration looks like " + unit->text +
                         ": declare its unit, or set fitting.keypoints.audit.unit to correct"
                   : "check the calibration's unit");
}

}  // namespace mocurate
