#include "ingest/checks/root_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/quality/tracked_points.h"
#include "ingest/inspect/inspection.h"

namespace mocurate {
namespace {

constexpr int kLags[] = {2, 4, 8, 16};  // frames; the one that shows most decides
constexpr double kLeastStep = 0.005;    // of the body against the standing foot, of its own height
constexpr double kAgainst = 0.8;        // least cosine between the step of the root and that of the body
constexpr std::size_t kFewestSteps = 20;
constexpr double kLeastShare = 0.5;
constexpr double kHighestFloor = 10.0;  // lengths of a leg
constexpr double kHeightSure = 0.6;
constexpr double kOtherUnit = 8.0;  // least factor between two units; metres and centimetres are 100 apart

/// Between two frames in which one foot stands.
struct RootStep {
  Vector3d root;  ///< how far the root goes
  Vector3d own;   ///< how far it goes against the foot, which is the body's own
};

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

/// A body that stands on its feet most of the time.
struct StandingBody {
  static std::optional<StandingBody> Of(const JointPositions& places, const BodyLandmarks& body);
  std::vector<RootStep> Steps(int lag) const;

  const JointPositions& places;
  int feet[2];
  Vector3d up;
  double reach;  ///< from the root to a foot
};

std::optional<StandingBody> StandingBody::Of(const JointPositions& places, const BodyLandmarks& body) {
  const bool toes = body.toe[0] >= 0 && body.toe[1] >= 0;
  StandingBody standing{
      places, {toes ? body.toe[0] : body.ankle[0], toes ? body.toe[1] : body.ankle[1]}, Vector3d::Zero(), 0.0};
  const int(&feet)[2] = standing.feet;
  if (feet[0] < 0 || feet[1] < 0 || body.head < 0 || places.frames < 2) return std::nullopt;
  standing.up = FeetToHead(places, feet, body.head);
  std::vector<double> reach;
  for (int f = 0; f < places.frames; ++f)
    reach.push_back((Vector3d(places.at(f, feet[0])) - Vector3d(places.at(f, 0))).norm());
  standing.reach = Median(reach);
  return standing;
}

std::vector<RootStep> StandingBody::Steps(int lag) const {
  std::vector<RootStep> steps;
  for (int f = 0; f + lag < places.frames; ++f) {
    const int foot = StandingFoot(places, feet, up, f, f + lag);
    if (foot < 0) continue;
    const Vector3d root = Vector3d(places.at(f + lag, 0)) - Vector3d(places.at(f, 0));
    const Vector3d own = root - (Vector3d(places.at(f + lag, foot)) - Vector3d(places.at(f, foot)));
    if (own.norm() >= kLeastStep * reach && root.norm() > 0.0) steps.push_back({root, own});
  }
  return steps;
}

/// Who stands still shows how far from the floor: recordings put it near zero, by a few metres at most.
std::optional<RootScale> ByHeight(const JointPositions& places, const int (&feet)[2], const Vector3d& up,
                                  double reach) {
  std::vector<double> feet_height, root_height;
  for (int f = 0; f < places.frames; ++f) {
    feet_height.push_back(std::min(up.dot(places.at(f, feet[0])), up.dot(places.at(f, feet[1]))));
    root_height.push_back(up.dot(places.at(f, 0)));
  }
  const double over_floor = Median(feet_height);
  if (!(over_floor > kHighestFloor * reach)) return std::nullopt;
  const double factor = reach / Median(root_height);
  return RootScale{factor, kHeightSure,
                   "the feet are " + Digits(over_floor / reach) + " lengths of a leg above the zero of the frame"};
}

}  // namespace

std::optional<RootScale> MeasureRootScale(const JointPositions& places, const BodyLandmarks& body) {
  const std::optional<StandingBody> standing = StandingBody::Of(places, body);
  if (!standing) return std::nullopt;
  std::optional<RootScale> best;
  std::size_t most = kFewestSteps - 1;
  for (const int lag : kLags) {
    std::vector<double> factors;
    double against = 0.0, all = 0.0;
    const std::vector<RootStep> steps = standing->Steps(lag);
    for (const RootStep& step : steps) {
      all += step.own.norm();
      if (step.root.dot(step.own) <= kAgainst * step.root.norm() * step.own.norm()) continue;
      against += step.own.norm();
      factors.push_back(step.own.norm() / step.root.norm());
    }
    if (factors.size() <= most) continue;
    const double share = against / all;
    if (share < kLeastShare) continue;
    most = factors.size();
    const double factor = Median(factors);
    best = RootScale{factor, share,
                     Digits(100.0 * share) + " % of the way in " + Counted(steps.size(), "moment") +
                         " on a standing foot agree: where the root moves by 1, the body moves by " + Digits(factor)};
  }
  return best ? best : ByHeight(places, standing->feet, standing->up, standing->reach);
}

std::optional<Finding> CheckRootPath(const JointPositions& places, const BodyLandmarks& body) {
  const std::optional<RootScale> scale = MeasureRootScale(places, body);
  if (!scale || !std::isfinite(scale->factor) || !(scale->factor > 0.0)) return std::nullopt;
  if (scale->factor < kOtherUnit && scale->factor > 1.0 / kOtherUnit) return std::nullopt;
  Finding finding = MakeFinding("units_contradiction", Severity::kError, FourDecimals(scale->factor),
                                "the path of the root and the lengths of the bones are of two units (" +
                                    scale->evidence + "): multiply the positions of the root by " +
                                    Digits(scale->factor) + ", or give the bones the unit of the path");
  finding.limit = scale->factor > 1.0 ? kOtherUnit : 1.0 / kOtherUnit;
  return finding;
}

}  // namespace mocurate
