#include "core/quality/rate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/median.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

/// A person as mechanics sees one: metres, y up, one entry a frame.
struct BodyPath {
  std::vector<Vector3d> centre;                 ///< of mass
  std::array<std::vector<Vector3d>, 2> foot;    ///< left, right: between ankle and toe
  std::vector<std::vector<Vector3d>> limb_end;  ///< observed wrists and ankles, relative to the middle of the hips
  double leg = 0.0;                             ///< hip to ankle along the bones

  int frames() const { return static_cast<int>(centre.size()); }
};

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

/// Hips, knees, ankles and shoulders must be observed in nearly all frames (98 %), at a constant frame rate; short gaps
/// are interpolated linearly. Segment masses after de Leva (1996), hands and feet included in their limbs. Empty where
/// that fails or for fewer than 12 frames.
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

/// Second differences over `lag` frames on either side, per frame^2: the mean acceleration of that time, weighted like
/// a tent. Entry i is of frame i + lag.
std::vector<Vector3d> Accelerations(const std::vector<Vector3d>& path, int lag) {
  std::vector<Vector3d> accelerations;
  const auto k = static_cast<std::size_t>(lag);
  for (std::size_t f = k; f + k < path.size(); ++f) {
    accelerations.emplace_back((path[f + k] - 2.0 * path[f] + path[f - k]) / (lag * lag));
  }
  return accelerations;
}

/// Standard deviation of white noise that explains all third differences of a path along `axis`: fast motion counts as
/// noise too, never the other way round.
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
