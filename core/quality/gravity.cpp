#include "core/quality/gravity.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/quality/swaps.h"

namespace mocurate {
namespace {

constexpr double kGravity = 9.81;
constexpr double kOffFloor = 0.05;  // metres over the feet's lowest
constexpr double kFloorShare = 0.05;
constexpr int kFewestFrames = 4;
constexpr double kShortest = 0.02;   // seconds as marked, which may be wrong by a factor of four
constexpr double kVertical = 0.004;  // metres, root mean square from a parabola
constexpr double kHorizontal = 0.010;
constexpr double kLeastSag = 0.01;                    // metres that the parabola bends over the flight, against noise
constexpr double kHighFlight = 0.08;                  // metres; tells alone
constexpr double kWeakest = 1.8, kStrongest = 250.0;  // m/s2: times wrong by 2.3 to 0.2; slower paths are no flights
constexpr double kAgree = 1.6;                        // quartiles of the flights' gravity
constexpr double kSlowest = 0.75, kFastest = 1.33;

std::vector<int> FeetOf(const TrackedPoints& points) {
  std::vector<int> feet;
  for (const auto& pair : FindLimbPairs(points.names).legs) {
    for (const int k : pair) {
      std::string name = points.name(k);
      std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
      for (const char* word : {"foot", "ankle", "toe", "heel"}) {
        if (name.find(word) == std::string::npos) continue;
        feet.push_back(k);
        break;
      }
    }
  }
  return feet;
}

/// Least squares of a polynomial; root mean square of what is left.
double Residual(const Eigen::VectorXd& time, const Eigen::VectorXd& value, int degree, Eigen::VectorXd& coefficients) {
  Eigen::MatrixXd powers(time.size(), degree + 1);
  for (int i = 0; i <= degree; ++i) powers.col(i) = time.array().pow(i);
  coefficients = powers.colPivHouseholderQr().solve(value);
  return std::sqrt((powers * coefficients - value).squaredNorm() / static_cast<double>(time.size()));
}

bool AllSeen(const TrackedPoints& points, int f) {
  for (int k = 0; k < points.count(); ++k) {
    if (!points.sees(f, k)) return false;
  }
  return true;
}

std::optional<Flight> FitFlight(const TrackedPoints& points, int begin, int end) {
  const int count = end - begin;
  const double lasts = points.time_s[end - 1] - points.time_s[begin];
  if (count < kFewestFrames || lasts < kShortest) return std::nullopt;
  Eigen::VectorXd time(count);
  Eigen::MatrixXd centre = Eigen::MatrixXd::Zero(count, 3);
  for (int f = begin; f < end; ++f) {
    time[f - begin] = (points.time_s[f] - points.time_s[begin]) / lasts;
    for (int k = 0; k < points.count(); ++k) centre.row(f - begin) += points.at(f, k).transpose() / points.count();
  }
  Eigen::VectorXd coefficients;
  const double vertical = Residual(time, centre.col(1), 2, coefficients);
  const double gravity = -2.0 * coefficients[2] / (lasts * lasts);
  const double sag = -coefficients[2] / 4.0;
  const double x = Residual(time, centre.col(0), 1, coefficients);
  const double z = Residual(time, centre.col(2), 1, coefficients);
  const bool flies = vertical < kVertical && std::max(x, z) < kHorizontal && sag > kLeastSag && gravity > kWeakest &&
                     gravity < kStrongest;
  if (!flies) return std::nullopt;
  return Flight{begin, end, gravity, sag, vertical};
}

}  // namespace

RateEvidence MeasureFlights(const TrackedPoints& points) {
  RateEvidence evidence;
  if (points.names.empty() || points.frames() < kFewestFrames) return evidence;
  const std::vector<int> feet = FeetOf(points);
  if (feet.size() < 2) return evidence;
  std::vector<double> lowest;
  std::vector<char> whole;
  for (int f = 0; f < points.frames(); ++f) {
    double low = 1e9;
    for (const int k : feet) {
      if (points.sees(f, k)) low = std::min(low, points.at(f, k).y());
    }
    lowest.push_back(low);
    whole.push_back(AllSeen(points, f) ? 1 : 0);
  }
  std::vector<double> heights = lowest;
  const auto floor = heights.begin() + static_cast<std::ptrdiff_t>(kFloorShare * static_cast<double>(heights.size()));
  std::nth_element(heights.begin(), floor, heights.end());
  const auto flies = [&](int f) {
    return whole[static_cast<std::size_t>(f)] != 0 && lowest[static_cast<std::size_t>(f)] > *floor + kOffFloor;
  };
  for (int f = 0; f < points.frames(); ++f) {
    const int begin = f;
    while (f < points.frames() && flies(f)) ++f;
    if (const auto flight = FitFlight(points, begin, f)) evidence.flights.push_back(*flight);
  }
  if (evidence.flights.empty()) return evidence;
  std::vector<double> gravity;
  for (const Flight& flight : evidence.flights) gravity.push_back(flight.gravity);
  std::sort(gravity.begin(), gravity.end());
  evidence.gravity = gravity[gravity.size() / 2];
  const bool agree = gravity[3 * gravity.size() / 4] <= kAgree * gravity[gravity.size() / 4];
  const double factor = std::sqrt(kGravity / evidence.gravity);
  const bool enough = gravity.size() > 1 || evidence.flights[0].sag > kHighFlight;
  if (enough && agree && (factor < kSlowest || factor > kFastest)) evidence.rate_factor = factor;
  return evidence;
}

std::vector<Finding> FindWrongRate(const TrackedPoints& points, double rate_hz) {
  const RateEvidence evidence = MeasureFlights(points);
  if (!evidence.rate_factor) return {};
  const std::size_t count = evidence.flights.size();
  const double rate = *evidence.rate_factor * rate_hz;
  return {FrameFinding("rate_doubtful", 0, 0, "", rate,
                       "bodies in the air fall with " + Digits(evidence.gravity) + " m/s2 (" + std::to_string(count) +
                           (count == 1 ? " flight" : " flights") + "): with 9.81 the rate would be near " +
                           Digits(rate) + " Hz, not " + Digits(rate_hz) + " Hz")};
}

}  // namespace mocurate
