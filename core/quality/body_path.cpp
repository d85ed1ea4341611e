#include "core/quality/body_path.h"

#include <algorithm>
#include <cmath>

#include "core/base/median.h"

namespace mocurate {
namespace {

constexpr double kSeen = 0.98;
constexpr int kFewestPathFrames = 12;
constexpr double kPace = 0.25;  // of the usual time between frames, that a step in time may differ by

using CentrePath = std::vector<Vector3d>;

/// One point in all frames, gaps interpolated; empty where it is observed too rarely.
CentrePath PathOf(const TrackedPoints& points, int point) {
  if (point < 0) return {};
  CentrePath path(static_cast<std::size_t>(points.frames()));
  int before = -1, seen = 0;
  for (int f = 0; f < points.frames(); ++f) {
    if (!points.sees(f, point)) continue;
    ++seen;
    path[static_cast<std::size_t>(f)] = points.at(f, point);
    const Vector3d from = before < 0 ? points.at(f, point) : points.at(before, point);
    for (int g = before + 1; g < f; ++g) {
      const double share = static_cast<double>(g - before) / (f - before);
      path[static_cast<std::size_t>(g)] = (1.0 - share) * from + share * points.at(f, point);
    }
    before = f;
  }
  if (seen < kSeen * points.frames()) return {};
  for (int g = before + 1; g < points.frames(); ++g) path[static_cast<std::size_t>(g)] = points.at(before, point);
  return path;
}

bool OnePace(const std::vector<double>& time_s) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time_s.size(); ++i) steps.push_back(time_s[i] - time_s[i - 1]);
  if (steps.empty()) return false;
  const double usual = Median(steps);
  return std::all_of(steps.begin(), steps.end(),
                     [&](double step) { return std::abs(step - usual) <= kPace * usual && usual > 0.0; });
}

double MedianDistance(const CentrePath& a, const CentrePath& b) {
  std::vector<double> lengths;
  for (std::size_t f = 0; f < a.size(); ++f) lengths.push_back((a[f] - b[f]).norm());
  return Median(std::move(lengths));
}

}  // namespace

std::optional<BodyPath> PathOfBody(const TrackedPoints& points) {
  if (points.frames() < kFewestPathFrames || !OnePace(points.time_s)) return std::nullopt;
  const BodyLandmarks& at = points.body;
  std::array<CentrePath, 2> hip, knee, ankle, toe, shoulder, wrist;
  for (std::size_t side = 0; side < 2; ++side) {
    hip[side] = PathOf(points, at.hip[side]);
    knee[side] = PathOf(points, at.knee[side]);
    ankle[side] = PathOf(points, at.ankle[side]);
    shoulder[side] = PathOf(points, at.shoulder[side]);
    if (hip[side].empty() || knee[side].empty() || ankle[side].empty() || shoulder[side].empty()) return std::nullopt;
    toe[side] = PathOf(points, at.toe[side]);
    wrist[side] = PathOf(points, at.wrist[side]);
  }
  const CentrePath head = PathOf(points, at.head);
  BodyPath body;
  for (std::size_t side = 0; side < 2; ++side) {
    body.leg += 0.5 * (MedianDistance(hip[side], knee[side]) + MedianDistance(knee[side], ankle[side]));
    for (const CentrePath* end : {&wrist[side], &ankle[side]}) {
      if (end->empty()) continue;
      body.limb_end.push_back(*end);
      for (std::size_t f = 0; f < end->size(); ++f) body.limb_end.back()[f] -= 0.5 * (hip[0][f] + hip[1][f]);
    }
  }
  for (std::size_t f = 0; f < hip[0].size(); ++f) {
    const Vector3d hips = 0.5 * (hip[0][f] + hip[1][f]), shoulders = 0.5 * (shoulder[0][f] + shoulder[1][f]);
    Vector3d sum = 0.44 * 0.5 * (hips + shoulders) + 0.08 * (head.empty() ? shoulders : head[f]);
    double mass = 0.44 + 0.08;
    for (std::size_t side = 0; side < 2; ++side) {
      const Vector3d hand = wrist[side].empty() ? shoulder[side][f] : wrist[side][f];
      sum += 0.05 * (0.6 * shoulder[side][f] + 0.4 * hand);
      sum += 0.14 * (0.57 * hip[side][f] + 0.43 * knee[side][f]);
      sum += 0.057 * (0.57 * knee[side][f] + 0.43 * ankle[side][f]);
      mass += 0.05 + 0.14 + 0.057;
      body.foot[side].push_back(toe[side].empty() ? ankle[side][f] : Vector3d(0.5 * (ankle[side][f] + toe[side][f])));
    }
    body.centre.emplace_back(sum / mass);
  }
  return body;
}

std::vector<Vector3d> Accelerations(const std::vector<Vector3d>& path, int lag) {
  std::vector<Vector3d> accelerations;
  const auto k = static_cast<std::size_t>(lag);
  for (std::size_t f = k; f + k < path.size(); ++f) {
    accelerations.emplace_back((path[f + k] - 2.0 * path[f] + path[f - k]) / (lag * lag));
  }
  return accelerations;
}

double MostNoise(const std::vector<Vector3d>& path, const Vector3d& axis) {
  if (path.size() < 4) return 0.0;
  double sum = 0.0;
  for (std::size_t f = 3; f < path.size(); ++f) {
    const double third = axis.dot(path[f] - 3.0 * path[f - 1] + 3.0 * path[f - 2] - path[f - 3]);
    sum += third * third;
  }
  constexpr double kOfWhiteNoise = 20.0;  // 1 + 9 + 9 + 1
  return std::sqrt(sum / static_cast<double>(path.size() - 3) / kOfWhiteNoise);
}

}  // namespace mocurate
