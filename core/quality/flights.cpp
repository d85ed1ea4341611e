#include "core/quality/flights.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

namespace mocurate {
namespace {

constexpr double kOffFloor = 0.05;  // metres over a sole's lowest
constexpr int kFewestFlightFrames = 5;
constexpr int kMargin = 3;          // frames before and behind, in which the body is on the floor
constexpr double kLeastSag = 0.02;  // metres
constexpr double kVertical = 0.03;  // of the sag, root mean square from a parabola
constexpr double kHorizontal = 0.2;
constexpr double kTrunk = 0.2;  // between the trunk's fall and that of the centre of mass
constexpr double kPush = 0.3;   // of the fall: least acceleration upwards at take-off and landing

/// Least squares of a polynomial of time in [-1, 1]; `residual` returns the root mean square residual.
Eigen::VectorXd Fit(const std::vector<Vector3d>& path, int begin, int end, int axis, int degree, double& residual) {
  const int count = end - begin;
  const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(count, -1.0, 1.0);
  Eigen::MatrixXd powers(count, degree + 1);
  Eigen::VectorXd value(count);
  for (int i = 0; i <= degree; ++i) powers.col(i) = time.array().pow(i);
  for (int i = 0; i < count; ++i) value[i] = path[static_cast<std::size_t>(begin) + static_cast<std::size_t>(i)][axis];
  Eigen::VectorXd coefficients = powers.colPivHouseholderQr().solve(value);
  residual = std::sqrt((powers * coefficients - value).squaredNorm() / count);
  return coefficients;
}

/// Strongest acceleration upwards among frames [begin, end), per frame^2.
double PushOf(const std::vector<Vector3d>& path, int begin, int end, int lag) {
  double push = -1e9;
  for (int f = std::max(begin, lag); f < std::min(end, static_cast<int>(path.size()) - lag); ++f) {
    const auto at = [&](int frame) { return path[static_cast<std::size_t>(frame)].y(); };
    push = std::max(push, (at(f + lag) - 2.0 * at(f) + at(f - lag)) / (lag * lag));
  }
  return push;
}

std::optional<Flight> FitFlight(const BodyPath& body, int begin, int end) {
  const int count = end - begin;
  if (count < kFewestFlightFrames || begin < kMargin || end > body.frames() - kMargin) return std::nullopt;
  double vertical = 0.0, unused = 0.0, x = 0.0, z = 0.0;
  const double half = 0.5 * (count - 1);
  const double sag = -Fit(body.centre, begin, end, 1, 2, vertical)[2];
  const double trunk = -Fit(body.trunk, begin, end, 1, 2, unused)[2];
  Fit(body.centre, begin, end, 0, 1, x);
  Fit(body.centre, begin, end, 2, 1, z);
  const bool flies = sag > kLeastSag && vertical < kVertical * sag && std::max(x, z) < kHorizontal * sag &&
                     std::abs(trunk / sag - 1.0) < kTrunk;
  if (!flies) return std::nullopt;
  const double fall = 2.0 * sag / (half * half);
  const int around = std::max(2, count / 4), lag = std::max(1, count / 8);
  const double push =
      std::min(PushOf(body.centre, begin - around, begin, lag), PushOf(body.centre, end, end + around, lag));
  if (push < kPush * fall) return std::nullopt;
  return Flight{begin, end, fall, sag, vertical};
}

}  // namespace

std::vector<Flight> FindFlights(const BodyPath& body) {
  std::vector<Flight> flights;
  const auto flies = [&](int f) {
    return std::all_of(body.sole.begin(), body.sole.end(),
                       [&](const auto& sole) { return sole[static_cast<std::size_t>(f)] > kOffFloor; });
  };
  for (int f = 0; f < body.frames(); ++f) {
    const int begin = f;
    while (f < body.frames() && flies(f)) ++f;
    if (const auto flight = FitFlight(body, begin, f)) flights.push_back(*flight);
  }
  return flights;
}

}  // namespace mocurate
