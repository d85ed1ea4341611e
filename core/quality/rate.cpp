#include "core/quality/rate.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/text.h"
#include "core/quality/body_path.h"

namespace mocurate {
namespace {

constexpr double kGravity = 9.81;

// Stances: one foot is in contact, is the lower one, and the body is upright over it.
constexpr double kStands = 0.35;     // of the other foot's speed
constexpr double kUnderBody = 0.7;   // of the centre's speed
constexpr double kLower = 0.02;      // metres that the standing foot may be higher
constexpr double kUpright = 0.8;     // height of the centre over the foot, in leg lengths
constexpr double kStanceToLag = 10;  // frames of a stance per frame of lag
constexpr int kFewestStepFrames = 3;
constexpr int kFewestSteps = 4;
constexpr std::size_t kFewestSamples = 16;  // coordinates

// Steps: feet are not points, and the pendulum is an approximation.
constexpr double kStepLeast = 0.3, kStepMost = 2.8;
constexpr double kCoarseLeast = 0.15;  // where accelerations are averaged over much of a step, at few frames
constexpr int kFineStance = 8;         // frames
constexpr double kStepCorrelation = 0.7;
constexpr double kStepLean = 0.08;

// Falls and limbs.
constexpr double kFastestFall = 1.7;  // g
constexpr int kLags[] = {1, 2, 3, 4, 6, 8, 12, 16, 24};
constexpr double kNoiseOfSecond = 5.0;     // sigmas of noise in a second difference, subtracted
constexpr double kLimbAcceleration = 150;  // m/s2
constexpr double kLimbShare = 0.75;        // quantile of the frames
constexpr std::size_t kLimbLag = 2;

/// Hz at which metres per frame^2 are `metres_per_s2`.
double RateFor(double per_frame2, double metres_per_s2) { return std::sqrt(metres_per_s2 / per_frame2); }

void AddEvidence(const std::string& evidence, RateLimits& limits) {
  limits.evidence += (limits.evidence.empty() ? "" : "; ") + evidence;
}

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

/// While one foot bears the body, the centre of mass at height h and horizontal distance d from it is accelerated by
/// g d / h (Winter 1995, Hof 2005). Times wrong by a factor n give n^2 times g with the same correlation. A low
/// correlation means that the model does not hold (slow, leaning, hand-made motion).
void LimitBySteps(const BodyPath& body, RateLimits& limits) {
  const std::vector<Stance> stances = StancesOf(body);
  if (stances.empty()) return;
  std::vector<int> lasts;
  for (const Stance& stance : stances) lasts.push_back(stance.end - stance.begin);
  std::sort(lasts.begin(), lasts.end());
  const int usual = lasts[lasts.size() / 2];
  const int lag = std::max(1, static_cast<int>(std::lround(usual / kStanceToLag)));
  const std::vector<Vector3d> accelerations = Accelerations(body.centre, lag);
  double xx = 0.0, xy = 0.0, yy = 0.0;
  std::size_t samples = 0;
  int steps = 0;
  for (const Stance& stance : stances) {
    const bool whole = stance.end - stance.begin > 2 * lag;
    const int middle = (stance.begin + stance.end) / 2;
    const int begin = std::max(whole ? stance.begin + lag : middle, lag);
    const int end = std::min(whole ? stance.end - lag : middle + 1, body.frames() - lag);
    if (end <= begin) continue;
    ++steps;
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
  if (steps < kFewestSteps || samples < kFewestSamples || !(xx > 0.0) || !(yy > 0.0)) return;
  const double correlation = xy / std::sqrt(xx * yy), lean = std::sqrt(xx / static_cast<double>(samples));
  if (correlation < kStepCorrelation || lean < kStepLean) return;
  const double per_frame2 = xy / xx;
  limits.lowest = RateFor(per_frame2, (usual < kFineStance ? kCoarseLeast : kStepLeast) * kGravity);
  limits.highest = std::min(limits.highest, RateFor(per_frame2, kStepMost * kGravity));
  AddEvidence(Counted(static_cast<std::size_t>(steps), "step") + " match an inverted pendulum under gravity at " +
                  Digits(limits.lowest) + " to " + Digits(RateFor(per_frame2, kStepMost * kGravity)) + " Hz",
              limits);
}

/// The level that `count` separate stretches of `length` values reach throughout.
double ReachedBy(const std::vector<double>& values, int length, int count) {
  std::vector<double> least;
  for (std::size_t i = 0; i + static_cast<std::size_t>(length) <= values.size(); ++i) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(i);
    least.push_back(*std::min_element(begin, begin + length));
  }
  double reached = 0.0;
  for (int n = 0; n < count; ++n) {
    const auto best = std::max_element(least.begin(), least.end());
    if (best == least.end() || *best <= 0.0) return 0.0;
    reached = *best;
    const auto at = static_cast<int>(best - least.begin());
    for (int i = std::max(0, at - length); i < std::min(static_cast<int>(least.size()), at + length + 1); ++i)
      least[static_cast<std::size_t>(i)] = 0.0;
  }
  return reached;
}

/// The fastest fall of the centre of mass beyond noise, twice or for long.
void LimitByFall(const BodyPath& body, RateLimits& limits) {
  const double noise = MostNoise(body.centre, Vector3d::UnitY());
  double fall = 0.0;
  for (const int lag : kLags) {
    if (4 * lag + 4 > body.frames()) break;
    std::vector<double> down;
    for (const Vector3d& acceleration : Accelerations(body.centre, lag)) down.push_back(-acceleration.y());
    const double reached = std::max(ReachedBy(down, lag + 1, 2), ReachedBy(down, 2 * lag + 2, 1));
    fall = std::max(fall, reached - kNoiseOfSecond * noise / (lag * lag));
  }
  if (!(fall > 0.0)) return;
  const double highest = RateFor(fall, kFastestFall * kGravity);
  limits.highest = std::min(limits.highest, highest);
  AddEvidence("above " + Digits(highest) + " Hz the body would fall faster than under gravity", limits);
}

void LimitByLimbs(const BodyPath& body, RateLimits& limits) {
  double fastest = 0.0;
  for (const std::vector<Vector3d>& path : body.limb_end) {
    double noise2 = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double noise = MostNoise(path, Vector3d::Unit(axis));
      noise2 += noise * noise;
    }
    std::vector<double> accelerations;
    for (const Vector3d& acceleration : Accelerations(path, kLimbLag)) accelerations.push_back(acceleration.norm());
    if (accelerations.empty()) continue;
    const auto reached =
        accelerations.begin() + static_cast<std::ptrdiff_t>(kLimbShare * static_cast<double>(accelerations.size() - 1));
    std::nth_element(accelerations.begin(), reached, accelerations.end());
    fastest = std::max(fastest, *reached - kNoiseOfSecond * std::sqrt(noise2) / (kLimbLag * kLimbLag));
  }
  if (!(fastest > 0.0)) return;
  const double highest = RateFor(fastest, kLimbAcceleration);
  limits.highest = std::min(limits.highest, highest);
  AddEvidence("above " + Digits(highest) + " Hz hands or feet would be accelerated by more than 150 m/s2", limits);
}

}  // namespace

std::string RateLimits::Range() const {
  if (lowest <= 0.0) return "at most " + Digits(highest) + " Hz";
  return Digits(lowest) + " to " + Digits(highest) + " Hz";
}

RateLimits MeasureRate(const TrackedPoints& points) {
  RateLimits limits;
  const std::optional<BodyPath> body = PathOfBody(points);
  if (!body) return limits;
  LimitBySteps(*body, limits);
  LimitByFall(*body, limits);
  LimitByLimbs(*body, limits);
  return limits;
}

std::vector<Finding> FindWrongRate(const TrackedPoints& points, double rate_hz) {
  const RateLimits limits = MeasureRate(points);
  if (limits.Allows(rate_hz)) return {};
  return {FrameFinding("rate_suspect", 0, 0, "", rate_hz < limits.lowest ? limits.lowest : limits.highest,
                       "the motion fits " + limits.Range() + ", not " + Digits(rate_hz) + " Hz: " + limits.evidence)};
}

}  // namespace mocurate
