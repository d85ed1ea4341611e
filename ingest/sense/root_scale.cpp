#include "ingest/sense/root_scale.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/text.h"
#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

constexpr int kLags[] = {2, 4, 8, 16};  // frames; the one that shows most decides
constexpr double kLeastStep = 0.005;    // of the body against the standing foot, of its own height
constexpr double kAgainst = 0.8;        // least cosine between the step of the root and that of the body
constexpr std::size_t kFewestSteps = 20;
constexpr double kLeastShare = 0.5;
constexpr double kHighestFloor = 10.0;  // lengths of a leg
constexpr double kHeightSure = 0.6;

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The foot that is lower in both frames, if it is one.
int StandingFoot(const JointPositions& places, const int (&feet)[2], const Vector3d& up, int first, int second) {
  const auto lower = [&](int f) {
    return up.dot(places.at(f, feet[0])) <= up.dot(places.at(f, feet[1])) ? feet[0] : feet[1];
  };
  const int foot = lower(first);
  return foot == lower(second) ? foot : -1;
}

Vector3d FeetToHead(const JointPositions& places, const int (&feet)[2], int head) {
  Vector3d sum = Vector3d::Zero();
  for (int f = 0; f < places.frames; ++f)
    sum += Vector3d(places.at(f, head)) - 0.5 * (Vector3d(places.at(f, feet[0])) + Vector3d(places.at(f, feet[1])));
  return sum.normalized();
}

/// Who stands still shows how far from the floor: recordings put it near zero, by a few metres at most.
std::optional<RootScale> ByHeight(const JointPositions& places, const int (&feet)[2], const Vector3d& up,
                                  double reach) {
  std::vector<double> feet_height, root_height;
  for (int f = 0; f < places.frames; ++f) {
    feet_height.push_back(std::min(up.dot(places.at(f, feet[0])), up.dot(places.at(f, feet[1]))));
    root_height.push_back(up.dot(places.at(f, 0)));
  }
  const double over_floor = MedianOf(feet_height);
  if (!(over_floor > kHighestFloor * reach)) return std::nullopt;
  const double factor = reach / MedianOf(root_height);
  return RootScale{factor, kHeightSure,
                   "the feet are " + Digits(over_floor / reach) + " lengths of a leg above the zero of the frame"};
}

}  // namespace

std::optional<RootScale> MeasureRootScale(const JointPositions& places, const HandednessPoints& body) {
  const bool toes = body.toe[0] >= 0 && body.toe[1] >= 0;
  const int feet[2] = {toes ? body.toe[0] : body.ankle[0], toes ? body.toe[1] : body.ankle[1]};
  if (feet[0] < 0 || feet[1] < 0 || body.head < 0 || places.frames < 2) return std::nullopt;
  const Vector3d up = FeetToHead(places, feet, body.head);
  std::vector<double> reach;
  for (int f = 0; f < places.frames; ++f)
    reach.push_back((Vector3d(places.at(f, feet[0])) - Vector3d(places.at(f, 0))).norm());
  const double least = kLeastStep * MedianOf(reach);
  std::optional<RootScale> best;
  std::size_t most = kFewestSteps - 1;
  for (const int lag : kLags) {
    std::vector<double> factors;
    double against = 0.0, all = 0.0;
    std::size_t steps = 0;
    for (int f = 0; f + lag < places.frames; ++f) {
      const int foot = StandingFoot(places, feet, up, f, f + lag);
      if (foot < 0) continue;
      const Vector3d root = Vector3d(places.at(f + lag, 0)) - Vector3d(places.at(f, 0));
      const Vector3d own = (Vector3d(places.at(f + lag, 0)) - Vector3d(places.at(f + lag, foot))) -
                           (Vector3d(places.at(f, 0)) - Vector3d(places.at(f, foot)));
      if (own.norm() < least || !(root.norm() > 0.0)) continue;
      ++steps;
      all += own.norm();
      if (root.dot(own) <= kAgainst * root.norm() * own.norm()) continue;
      against += own.norm();
      factors.push_back(own.norm() / root.norm());
    }
    if (factors.size() <= most) continue;
    const double share = against / all;
    if (share < kLeastShare) continue;
    most = factors.size();
    const double factor = MedianOf(factors);
    best = RootScale{factor, share,
                     Digits(100.0 * share) + " % of the way in " + Counted(steps, "moment") +
                         " on a standing foot agree: where the root moves by 1, the body moves by " + Digits(factor)};
  }
  return best ? best : ByHeight(places, feet, up, MedianOf(reach));
}

}  // namespace mocurate
