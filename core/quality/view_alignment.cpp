#include "core/quality/view_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mocurate {
namespace {

constexpr int kReach = 2;  // frames either side of a derivative
constexpr int kFewestCommonFrames = 12;
constexpr double kLeastShare = 0.4;
constexpr double kRival = 0.7;
constexpr int kMostRivals = 5;
constexpr int kBlocks = 8;
constexpr double kLeastCommon = 0.3;  // correlation of the velocities: below, they are the trackers' noise
constexpr int kTurns = 8;
constexpr int kFewestAlignedPairs = 60;
constexpr int kMostFrames = 120;   // compared, evenly over the clip
constexpr double kWell = 0.5;      // product of both confidences
constexpr double kLine = 0.02;     // metres
constexpr double kSettled = 1e-5;  // seconds
constexpr double kAsGood = 1.1;    // times the least distance: below it the offset nearer to 0 is used
constexpr double kMirrored = 0.7;

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

/// A step towards the offset that lays the moving points on each other, and how sure it is.
struct ClockStep {
  double seconds = 0.0;  ///< to be added to the offset
  double sigma = 0.0;    ///< seconds, one standard deviation by leaving out an eighth of the frames at a time
  bool known = false;    ///< something moves, and as both see it: velocities correlate by 0.3 at least
};

/// Least squares of the positions over time, linear in the offset (each point's own bias between the trackers
/// removed), for points observed by both.
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

struct SeenPairs {
  Eigen::Matrix3Xd a, b;
  Eigen::VectorXd weights;
  int frames = 0;
};

SeenPairs PairsAt(const TrackedPoints& a, const TrackedPoints& b, double offset_s, double least) {
  std::vector<Vector3d> of_a, of_b;
  std::vector<double> weights;
  SeenPairs pairs;
  const int step = std::max(1, a.frames() / kMostFrames);
  for (int f = 0; f < a.frames(); f += step) {
    const std::size_t before = weights.size();
    for (int k = 0; k < a.count(); ++k) {
      if (!a.sees(f, k)) continue;
      const PointAt point = PointWhen(b, a.time_s[static_cast<std::size_t>(f)] - offset_s, k);
      const double weight = a.confidence_at(f, k) * point.confidence;
      if (!point.seen || weight < least) continue;
      of_a.emplace_back(a.at(f, k));
      of_b.push_back(point.place);
      weights.push_back(weight);
    }
    pairs.frames += weights.size() > before ? step : 0;
  }
  const auto count = static_cast<Eigen::Index>(weights.size());
  pairs.a.resize(3, count);
  pairs.b.resize(3, count);
  pairs.weights.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    pairs.a.col(i) = of_a[static_cast<std::size_t>(i)];
    pairs.b.col(i) = of_b[static_cast<std::size_t>(i)];
    pairs.weights[i] = weights[static_cast<std::size_t>(i)];
  }
  return pairs;
}

/// Points that both observe well; where these are too few, all that both observe.
SeenPairs PairsOf(const TrackedPoints& a, const TrackedPoints& b, double offset_s) {
  SeenPairs pairs = PairsAt(a, b, offset_s, kWell);
  if (pairs.weights.size() >= kFewestAlignedPairs && pairs.frames >= kFewestCommonFrames) return pairs;
  return PairsAt(a, b, offset_s, 1e-6);
}

std::optional<ViewAlignment> AlignFrom(const TrackedPoints& a, const TrackedPoints& b, double offset_s, bool moving,
                                       double most_offset_s) {
  ViewAlignment view;
  view.offset_s = offset_s;
  const double step = StepOf(a);
  for (int turn = 0;; ++turn) {
    const SeenPairs pairs = PairsOf(a, b, view.offset_s);
    view.pairs = static_cast<int>(pairs.weights.size());
    if (view.pairs < kFewestAlignedPairs || pairs.frames < kFewestCommonFrames) return std::nullopt;
    const RobustAlignment fit = AlignPointsRobustly(pairs.b, pairs.a, pairs.weights);
    if (fit.spread < kLine) return std::nullopt;
    view.a_from_b = fit.target_from_source;
    view.median = fit.median;
    view.share = fit.share;
    const ClockStep clock = moving && turn < kTurns ? RefineClock(a, b, view.a_from_b, view.offset_s) : ClockStep();
    if (clock.known) {
      view.offset_sigma_s = clock.sigma;
      view.offset_known = clock.sigma < 0.5 * step;
    }
    if (clock.known && view.offset_known && std::abs(clock.seconds) > kSettled) {
      view.offset_s = std::clamp(view.offset_s + std::clamp(clock.seconds, -step, step), -most_offset_s, most_offset_s);
      continue;
    }
    Eigen::Matrix3Xd mirrored = pairs.b;
    mirrored.row(0) *= -1.0;
    view.mirrored_median = AlignPointsRobustly(mirrored, pairs.a, pairs.weights).median;
    return view;
  }
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
  at.seen = true;
  at.confidence = std::min(b.confidence_at(before, point), b.confidence_at(after, point));
  at.place = (1.0 - part) * b.at(before, point) + part * b.at(after, point);
  return at;
}

bool ViewAlignment::Mirrored() const { return mirrored_median < kMirrored * median && median > 0.02; }

std::optional<ViewAlignment> AlignViews(const TrackedPoints& a, const TrackedPoints& b, double most_offset_s) {
  if (a.frames() < kFewestCommonFrames || b.frames() < kFewestCommonFrames || a.count() != b.count())
    return std::nullopt;
  std::optional<ViewAlignment> best = AlignFrom(a, b, 0.0, false, most_offset_s);
  std::vector<ViewAlignment> found;
  for (const ClockOffset& offset : CorrelateSpeeds(a, b, most_offset_s)) {
    std::optional<ViewAlignment> view = AlignFrom(a, b, offset.seconds, true, most_offset_s);
    if (view && view->offset_known) found.push_back(*view);
  }
  if (found.empty()) return best;
  double least = found.front().median;
  for (const ViewAlignment& view : found) least = std::min(least, view.median);
  const ViewAlignment* chosen = nullptr;
  for (const ViewAlignment& view : found) {
    if (view.median > kAsGood * least) continue;
    if (chosen == nullptr || std::abs(view.offset_s) < std::abs(chosen->offset_s)) chosen = &view;
  }
  return *chosen;
}

}  // namespace mocurate
