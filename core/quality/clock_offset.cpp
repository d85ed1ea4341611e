#include "core/quality/clock_offset.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mocurate {
namespace {

constexpr int kReach = 2;                // frames either side of a derivative
constexpr int kFewestCommonFrames = 12;  // in common
constexpr double kLeastShare = 0.4;
constexpr double kRival = 0.7;
constexpr int kMostRivals = 5;
constexpr int kBlocks = 8;
constexpr double kLeastCommon = 0.3;  // correlation of the velocities: below, they are the trackers' noise

double StepOf(const TrackedPoints& points) {
  const auto last = static_cast<std::size_t>(points.frames()) - 1;
  return (points.time_s[last] - points.time_s[0]) / static_cast<double>(last);
}

/// Slope of the line through five frames, per second.
bool VelocityAt(const TrackedPoints& points, int frame, int point, double step_s, Vector3d& velocity) {
  if (frame < kReach || frame + kReach >= points.frames()) return false;
  velocity.setZero();
  for (int d = -kReach; d <= kReach; ++d) {
    if (!points.sees(frame + d, point)) return false;
    velocity += d * points.at(frame + d, point);
  }
  velocity /= 10.0 * step_s;
  return true;
}

/// (frames*points) metres per second, -1 where unknown.
std::vector<double> SpeedsOf(const TrackedPoints& points, double step_s) {
  std::vector<double> speeds(static_cast<std::size_t>(points.frames()) * points.count(), -1.0);
  Vector3d velocity;
  for (int f = 0; f < points.frames(); ++f) {
    for (int k = 0; k < points.count(); ++k) {
      if (!VelocityAt(points, f, k, step_s, velocity)) continue;
      speeds[static_cast<std::size_t>(f) * points.count() + k] = velocity.norm();
    }
  }
  return speeds;
}

struct Sums {
  double n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
};

/// Correlation of frame f of a with frame f - lag of b; below -1 where the overlap is too small.
double CorrelationAt(const std::vector<double>& a, const std::vector<double>& b, int frames_a, int frames_b, int points,
                     int lag) {
  const int begin = std::max(0, lag), end = std::min(frames_a, frames_b + lag);
  const double fewest = std::max<double>(kFewestCommonFrames, kLeastShare * std::min(frames_a, frames_b));
  if (end - begin < fewest) return -2.0;
  double ab = 0.0, aa = 0.0, bb = 0.0;
  for (int k = 0; k < points; ++k) {
    Sums sum;
    for (int f = begin; f < end; ++f) {
      const double x = a[static_cast<std::size_t>(f) * points + k];
      const double y = b[static_cast<std::size_t>(f - lag) * points + k];
      if (x < 0.0 || y < 0.0) continue;
      sum.n += 1.0, sum.a += x, sum.b += y, sum.aa += x * x, sum.bb += y * y, sum.ab += x * y;
    }
    if (2.0 * sum.n < kFewestCommonFrames) continue;
    ab += sum.ab - sum.a * sum.b / sum.n;
    aa += sum.aa - sum.a * sum.a / sum.n;
    bb += sum.bb - sum.b * sum.b / sum.n;
  }
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : -2.0;
}

}  // namespace

std::vector<ClockOffset> CorrelateSpeeds(const TrackedPoints& a, const TrackedPoints& b, double most_s) {
  std::vector<ClockOffset> offsets;
  if (a.frames() < kFewestCommonFrames || b.frames() < kFewestCommonFrames) return offsets;
  const double step = StepOf(a);
  const std::vector<double> speeds_a = SpeedsOf(a, step), speeds_b = SpeedsOf(b, StepOf(b));
  const double between = b.time_s[0] - a.time_s[0];
  const int most = static_cast<int>(std::ceil(most_s / step));
  const int declared = static_cast<int>(std::lround(between / step));  // the lag of equal clocks
  std::vector<double> correlation;
  for (int lag = declared - most - 1; lag <= declared + most + 1; ++lag) {
    correlation.push_back(CorrelationAt(speeds_a, speeds_b, a.frames(), b.frames(), a.count(), lag));
  }
  for (std::size_t i = 1; i + 1 < correlation.size(); ++i) {
    const double before = correlation[i - 1], here = correlation[i], after = correlation[i + 1];
    if (here <= 0.0 || before < -1.0 || after < -1.0 || here < before || here <= after) continue;
    const double curve = before - 2.0 * here + after;
    const double part = curve < 0.0 ? std::clamp(0.5 * (before - after) / curve, -0.5, 0.5) : 0.0;
    const double lag = declared + static_cast<double>(i) - most - 1 + part;
    offsets.push_back({lag * step - between, here - 0.25 * (before - after) * part});
  }
  std::stable_sort(offsets.begin(), offsets.end(),
                   [](const ClockOffset& x, const ClockOffset& y) { return x.correlation > y.correlation; });
  while (!offsets.empty() && (offsets.back().correlation < kRival * offsets.front().correlation ||
                              offsets.size() > static_cast<std::size_t>(kMostRivals))) {
    offsets.pop_back();
  }
  return offsets;
}

PointAt PointWhen(const TrackedPoints& b, double time_s, int point) {
  PointAt at;
  if (b.frames() == 0) return at;
  constexpr double kExact = 1e-9;
  const double frame =
      b.frames() == 1 ? (std::abs(time_s - b.time_s[0]) < kExact ? 0.0 : -1.0) : (time_s - b.time_s[0]) / StepOf(b);
  const auto nearest = static_cast<int>(std::lround(std::clamp(frame, -1.0, static_cast<double>(b.frames()))));
  const bool on_frame = std::abs(frame - nearest) < 1e-6;
  const int before = on_frame ? nearest : static_cast<int>(std::floor(frame));
  const int after = on_frame ? nearest : before + 1;
  if (before < 0 || after >= b.frames() || !b.sees(before, point) || !b.sees(after, point)) return at;
  const double part = on_frame ? 0.0 : frame - before;
  const auto confidence = [&](int f) {
    return b.confidence.empty() ? 1.0 : b.confidence[static_cast<std::size_t>(f) * b.count() + point];
  };
  at.seen = true;
  at.confidence = std::min(confidence(before), confidence(after));
  at.place = (1.0 - part) * b.at(before, point) + part * b.at(after, point);
  return at;
}

ClockStep RefineClock(const TrackedPoints& a, const TrackedPoints& b, const RigidTransform& a_from_b, double offset_s) {
  struct Sample {
    Vector3d residual, velocity;
    int block;
  };
  const double step = StepOf(a), step_b = StepOf(b);
  std::array<double, kBlocks> along{}, square{};
  double common = 0.0, own_square = 0.0, other_square = 0.0;
  for (int k = 0; k < a.count(); ++k) {
    std::vector<Sample> samples;
    Vector3d residual = Vector3d::Zero(), velocity = Vector3d::Zero();
    for (int f = 0; f < a.frames(); ++f) {
      Sample sample;
      Vector3d own, other;
      if (!a.sees(f, k) || !VelocityAt(a, f, k, step, own)) continue;
      const double time = a.time_s[static_cast<std::size_t>(f)] - offset_s;
      const PointAt point = PointWhen(b, time, k);
      const auto near = static_cast<int>(std::lround((time - b.time_s[0]) / step_b));
      if (!point.seen || !VelocityAt(b, near, k, step_b, other)) continue;
      sample.residual = a.at(f, k) - a_from_b * point.place;
      other = a_from_b.rotation * other;
      sample.velocity = 0.5 * (own + other);
      common += own.dot(other), own_square += own.squaredNorm(), other_square += other.squaredNorm();
      sample.block = f * kBlocks / a.frames();
      residual += sample.residual;
      velocity += sample.velocity;
      samples.push_back(sample);
    }
    if (samples.size() < static_cast<std::size_t>(kFewestCommonFrames)) continue;
    residual /= static_cast<double>(samples.size());
    velocity /= static_cast<double>(samples.size());
    double typical = 0.0;
    for (const Sample& sample : samples) typical += (sample.residual - residual).squaredNorm();
    typical = std::max(1e-8, typical / static_cast<double>(samples.size()));
    for (const Sample& sample : samples) {
      const Vector3d r = sample.residual - residual, v = sample.velocity - velocity;
      const double robust = 1.0 / (1.0 + r.squaredNorm() / (2.0 * typical));
      // a(t) = b(t - offset - more) = b(t - offset) - more * velocity
      along[static_cast<std::size_t>(sample.block)] -= robust * v.dot(r);
      square[static_cast<std::size_t>(sample.block)] += robust * v.squaredNorm();
    }
  }
  ClockStep result;
  double all_along = 0.0, all_square = 0.0;
  for (std::size_t i = 0; i < kBlocks; ++i) all_along += along[i], all_square += square[i];
  if (all_square <= 0.0 || common < kLeastCommon * std::sqrt(own_square * other_square)) return result;
  result.seconds = all_along / all_square;
  double mean = 0.0, squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    if (all_square - square[i] <= 0.0) return result;
    const double without = (all_along - along[i]) / (all_square - square[i]);
    mean += without, squares += without * without, count += 1.0;
  }
  mean /= count;
  result.sigma = std::sqrt(std::max(0.0, (count - 1.0) * (squares / count - mean * mean)));
  result.known = true;
  return result;
}

}  // namespace mocurate
