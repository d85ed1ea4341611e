#include "core/quality/step_pendulum.h"

#include <algorithm>
#include <cmath>

namespace mocurate {
namespace {

constexpr double kStands = 0.35;     // of the other foot's speed
constexpr double kUnderBody = 0.7;   // of the centre's speed
constexpr double kLower = 0.02;      // metres that the standing foot may be higher
constexpr double kUpright = 0.8;     // height of the centre over the foot, in leg lengths
constexpr double kStanceToLag = 10;  // frames of a stance per frame of lag
constexpr int kFewestStepFrames = 3;
constexpr int kFewestSteps = 4;
constexpr std::size_t kFewestSamples = 16;  // coordinates

/// Horizontal metres per frame, over the frame before and behind.
std::vector<double> SpeedOf(const std::vector<Vector3d>& path) {
  std::vector<double> speed(path.size(), 0.0);
  for (std::size_t f = 1; f < path.size(); ++f) {
    const double step = std::hypot(path[f].x() - path[f - 1].x(), path[f].z() - path[f - 1].z());
    speed[f] += 0.5 * step;
    speed[f - 1] += 0.5 * step;
  }
  return speed;
}

struct Stance {
  int begin = 0;
  int end = 0;
  std::size_t foot = 0;
};

std::vector<Stance> StancesOf(const BodyPath& body) {
  const std::vector<double> centre = SpeedOf(body.centre);
  const std::vector<double> foot[2] = {SpeedOf(body.foot[0]), SpeedOf(body.foot[1])};
  std::vector<Stance> stances;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto stands = [&](int frame) {
      const auto f = static_cast<std::size_t>(frame);
      const double here = body.foot[side][f].y(), other = body.foot[1 - side][f].y();
      return foot[side][f] < kStands * foot[1 - side][f] && foot[side][f] < kUnderBody * centre[f] &&
             here < other + kLower && body.centre[f].y() - here > kUpright * body.leg;
    };
    for (int f = 0; f < body.frames(); ++f) {
      const int begin = f;
      while (f < body.frames() && stands(f)) ++f;
      if (f - begin >= kFewestStepFrames) stances.push_back({begin, f, side});
    }
  }
  return stances;
}

}  // namespace

std::optional<StepPendulum> MeasureStepPendulum(const BodyPath& body) {
  const std::vector<Stance> stances = StancesOf(body);
  if (stances.empty()) return std::nullopt;
  std::vector<int> lasts;
  for (const Stance& stance : stances) lasts.push_back(stance.end - stance.begin);
  std::sort(lasts.begin(), lasts.end());
  const int lag = std::max(1, static_cast<int>(std::lround(lasts[lasts.size() / 2] / kStanceToLag)));
  const std::vector<Vector3d> accelerations = Accelerations(body.centre, lag);
  StepPendulum pendulum;
  pendulum.stance = lasts[lasts.size() / 2];
  double xx = 0.0, xy = 0.0, yy = 0.0;
  std::size_t samples = 0;
  for (const Stance& stance : stances) {
    const bool whole = stance.end - stance.begin > 2 * lag;
    const int middle = (stance.begin + stance.end) / 2;
    const int begin = std::max(whole ? stance.begin + lag : middle, lag);
    const int end = std::min(whole ? stance.end - lag : middle + 1, body.frames() - lag);
    if (end <= begin) continue;
    ++pendulum.steps;
    for (int frame = begin; frame < end; ++frame) {
      const auto f = static_cast<std::size_t>(frame);
      const Vector3d from_foot = body.centre[f] - body.foot[stance.foot][f];
      for (const int axis : {0, 2}) {
        const double x = from_foot[axis] / from_foot.y();
        const double y = accelerations[f - static_cast<std::size_t>(lag)][axis];
        xx += x * x;
        xy += x * y;
        yy += y * y;
        ++samples;
      }
    }
  }
  if (pendulum.steps < kFewestSteps || samples < kFewestSamples || !(xx > 0.0) || !(yy > 0.0)) return std::nullopt;
  pendulum.correlation = xy / std::sqrt(xx * yy);
  pendulum.lean = std::sqrt(xx / static_cast<double>(samples));
  pendulum.gravity = xy / xx;
  return pendulum;
}

}  // namespace mocurate
