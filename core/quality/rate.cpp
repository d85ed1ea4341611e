#include "core/quality/rate.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/quality/flights.h"
#include "core/quality/step_pendulum.h"

namespace mocurate {
namespace {

constexpr double kGravity = 9.81;

// Flights: range of g / 9.81 m/s2 where the centre of mass is estimated from joints.
constexpr double kFlightLeast = 0.65, kFlightMost = 1.5;
constexpr double kFlightsAgree = 1.5;  // quartiles
constexpr double kHighFlight = 0.08;   // metres of sag; enough alone
constexpr double kFlightsSure = 0.9, kFlightSure = 0.7;

// Steps: feet are not points, and the pendulum is an approximation.
constexpr double kStepLeast = 0.3, kStepMost = 2.8;
constexpr double kCoarseLeast = 0.15;  // where accelerations are averaged over much of a step, at few frames
constexpr int kFineStance = 8;         // frames
constexpr double kStepUsual = 1.1;
constexpr double kStepCorrelation = 0.7;
constexpr double kStepLean = 0.08;
constexpr double kStepsSure = 0.5;

// Falls and limbs.
constexpr double kFastestFall = 1.7;  // g
constexpr int kLags[] = {1, 2, 3, 4, 6, 8, 12, 16, 24};
constexpr double kNoiseOfSecond = 5.0;     // sigmas of noise in a second difference, subtracted
constexpr double kLimbAcceleration = 150;  // m/s2
constexpr double kLimbShare = 0.75;        // quantile of the frames
constexpr std::size_t kLimbLag = 2;
constexpr double kLimitSure = 0.3;

/// Hz at which metres per frame^2 are `metres_per_s2`.
double RateFor(double per_frame2, double metres_per_s2) { return std::sqrt(metres_per_s2 / per_frame2); }

std::optional<RateClue> EstimateFromFlights(const BodyPath& body) {
  const std::vector<Flight> flights = FindFlights(body);
  if (flights.empty()) return std::nullopt;
  std::vector<double> fall;
  for (const Flight& flight : flights) fall.push_back(flight.fall);
  std::sort(fall.begin(), fall.end());
  const bool agree = fall[3 * fall.size() / 4] <= kFlightsAgree * fall[fall.size() / 4];
  if (!agree || (fall.size() == 1 && flights[0].sag < kHighFlight)) return std::nullopt;
  const double usual = fall[fall.size() / 2];
  RateClue clue;
  clue.rate_hz = RateFor(usual, kGravity);
  clue.lowest = RateFor(usual, kFlightLeast * kGravity);
  clue.highest = RateFor(usual, kFlightMost * kGravity);
  clue.confidence = fall.size() > 1 ? kFlightsSure : kFlightSure;
  clue.words = Counted(fall.size(), "flight") + " fall" + (fall.size() == 1 ? "s" : "") + " with 9.81 m/s2 at " +
               Digits(clue.rate_hz) + " Hz";
  return clue;
}

std::optional<RateClue> EstimateFromSteps(const BodyPath& body) {
  const std::optional<StepPendulum> steps = MeasureStepPendulum(body);
  if (!steps || steps->correlation < kStepCorrelation || steps->lean < kStepLean) return std::nullopt;
  RateClue clue;
  clue.rate_hz = RateFor(steps->gravity, kStepUsual * kGravity);
  clue.lowest = RateFor(steps->gravity, (steps->stance < kFineStance ? kCoarseLeast : kStepLeast) * kGravity);
  clue.highest = RateFor(steps->gravity, kStepMost * kGravity);
  clue.confidence = kStepsSure * steps->correlation;
  clue.words = Counted(static_cast<std::size_t>(steps->steps), "step") +
               " match an inverted pendulum under gravity at " + Digits(clue.lowest) + " to " + Digits(clue.highest) +
               " Hz";
  return clue;
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
std::optional<RateClue> EstimateFromFall(const BodyPath& body) {
  const double noise = MostNoise(body.centre, Vector3d::UnitY());
  double fall = 0.0;
  for (const int lag : kLags) {
    if (4 * lag + 4 > body.frames()) break;
    std::vector<double> down;
    for (const Vector3d& acceleration : Accelerations(body.centre, lag)) down.push_back(-acceleration.y());
    const double reached = std::max(ReachedBy(down, lag + 1, 2), ReachedBy(down, 2 * lag + 2, 1));
    fall = std::max(fall, reached - kNoiseOfSecond * noise / (lag * lag));
  }
  if (!(fall > 0.0)) return std::nullopt;
  RateClue clue;
  clue.highest = RateFor(fall, kFastestFall * kGravity);
  clue.confidence = kLimitSure;
  clue.words = "above " + Digits(clue.highest) + " Hz the body would fall faster than under gravity";
  return clue;
}

std::optional<RateClue> EstimateFromLimbs(const BodyPath& body) {
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
  if (!(fastest > 0.0)) return std::nullopt;
  RateClue clue;
  clue.highest = RateFor(fastest, kLimbAcceleration);
  clue.confidence = kLimitSure;
  clue.words = "above " + Digits(clue.highest) + " Hz hands or feet would be accelerated by more than 150 m/s2";
  return clue;
}

}  // namespace

std::optional<double> RateMeasure::rate_hz() const {
  if (!IsConclusive() || clues[0].rate_hz <= 0.0) return std::nullopt;
  return std::clamp(clues[0].rate_hz, lowest, highest);
}

std::string RateMeasure::Range() const {
  if (!std::isfinite(highest)) return "at least " + Digits(lowest) + " Hz";
  if (lowest <= 0.0) return "at most " + Digits(highest) + " Hz";
  return Digits(lowest) + " to " + Digits(highest) + " Hz";
}

std::string RateMeasure::Words() const {
  std::string words;
  for (const RateClue& clue : clues) words += (words.empty() ? "" : "; ") + clue.words;
  if (lowest > highest) words += "; these limits contradict each other";
  return words;
}

RateMeasure MeasureRate(const TrackedPoints& points) {
  RateMeasure measure;
  const std::optional<BodyPath> body = PathOfBody(points);
  if (!body) return measure;
  for (const auto estimate : {EstimateFromFlights, EstimateFromSteps, EstimateFromFall, EstimateFromLimbs}) {
    std::optional<RateClue> clue = estimate(*body);
    if (!clue) continue;
    measure.lowest = std::max(measure.lowest, clue->lowest);
    measure.highest = std::min(measure.highest, clue->highest);
    measure.clues.push_back(std::move(*clue));
  }
  return measure;
}

std::vector<Finding> FindWrongRate(const TrackedPoints& points, double rate_hz) {
  const RateMeasure measure = MeasureRate(points);
  if (measure.Allows(rate_hz)) return {};
  const double nearest = rate_hz < measure.lowest ? measure.lowest : measure.highest;
  const std::optional<double> likely = measure.rate_hz();
  return {FrameFinding("rate_suspect", 0, 0, "", likely.value_or(nearest),
                       "the motion fits " + measure.Range() +
                           (likely ? ", most likely " + Digits(*likely) + " Hz" : "") + ", not " + Digits(rate_hz) +
                           " Hz: " + measure.Words())};
}

}  // namespace mocurate
