#include "core/quality/tracked_points.h"

#include <algorithm>
#include <cmath>

#include "core/base/median.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr int kFewestCentrePoints = 3;

}  // namespace

PointBones BonesBetween(const std::vector<std::string>& names, const Skeleton& skeleton) {
  std::vector<std::optional<int>> joint_of;
  std::vector<int> point_of(static_cast<std::size_t>(skeleton.joint_count()), -1);
  for (std::size_t k = 0; k < names.size(); ++k) {
    joint_of.push_back(skeleton.FindJoint(names[k]));
    if (joint_of.back()) point_of[static_cast<std::size_t>(*joint_of.back())] = static_cast<int>(k);
  }
  PointBones bones{std::vector<int>(names.size(), -1), std::vector<double>(names.size(), 0.0)};
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!joint_of[k]) continue;
    Vector3d offset = Vector3d::Zero();
    int joint = *joint_of[k];
    do {
      offset += skeleton.joints[static_cast<std::size_t>(joint)].rest_offset;
      joint = skeleton.joints[static_cast<std::size_t>(joint)].parent;
    } while (joint >= 0 && point_of[static_cast<std::size_t>(joint)] < 0);
    if (joint < 0) continue;
    bones.parents[k] = point_of[static_cast<std::size_t>(joint)];
    bones.rest_lengths[k] = offset.norm();
  }
  return bones;
}

std::vector<BodyCentre> BodyCentres(const TrackedPoints& points) {
  std::vector<BodyCentre> centres(static_cast<std::size_t>(points.frames()));
  std::vector<double> values[3];
  for (int f = 0; f < points.frames(); ++f) {
    for (std::vector<double>& coordinate : values) coordinate.clear();
    for (int k = 0; k < points.count(); ++k) {
      if (!points.sees(f, k)) continue;
      const Vector3d place = points.at(f, k);
      for (int i = 0; i < 3; ++i) values[i].push_back(place[i]);
    }
    BodyCentre& centre = centres[static_cast<std::size_t>(f)];
    centre.seen =
        static_cast<int>(values[0].size()) >= std::min(kFewestCentrePoints, points.count()) && !values[0].empty();
    for (int i = 0; centre.seen && i < 3; ++i) centre.place[i] = MeanMedian(values[i]);
  }
  return centres;
}

std::optional<Vector3d> BodyStep(const TrackedPoints& points, int from, int to) {
  std::vector<double> values[3];
  for (int k = 0; k < points.count(); ++k) {
    if (!points.sees(from, k) || !points.sees(to, k)) continue;
    const Vector3d way = points.at(to, k) - points.at(from, k);
    for (int i = 0; i < 3; ++i) values[i].push_back(way[i]);
  }
  if (static_cast<int>(values[0].size()) < std::min(kFewestCentrePoints, points.count()) || values[0].empty())
    return {};
  return Vector3d(MeanMedian(values[0]), MeanMedian(values[1]), MeanMedian(values[2]));
}

Finding FrameFinding(const char* code, int begin, int end, const std::string& joint, double value,
                     std::string message) {
  Finding finding;
  finding.code = code;
  finding.frame_begin = begin;
  finding.frame_end = end;
  finding.joint = joint;
  finding.value = value;
  finding.message = std::move(message);
  finding.action = FindingAction::kFlagged;
  return finding;
}

std::string Digits(double value) {
  if (value == 0.0 || !std::isfinite(value)) return FormatDouble(value);
  const int decimals = std::clamp(2 - static_cast<int>(std::floor(std::log10(std::abs(value)))), -300, 300);
  const double unit = std::pow(10.0, std::abs(decimals));
  return FormatDouble(decimals >= 0 ? std::round(value * unit) / unit : std::round(value / unit) * unit);
}

}  // namespace mocurate
