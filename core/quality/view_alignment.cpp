#include "core/quality/view_alignment.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geometry/robust_alignment.h"
#include "core/quality/clock_offset.h"

namespace mocurate {
namespace {

constexpr int kTurns = 8;
constexpr int kFewestAlignedFrames = 12;
constexpr int kFewestAlignedPairs = 60;
constexpr int kMostFrames = 120;   // compared, evenly over the clip
constexpr double kWell = 0.5;      // product of both confidences
constexpr double kLine = 0.02;     // metres
constexpr double kSettled = 1e-5;  // seconds
constexpr double kAsGood = 1.1;    // times the least distance: below it the offset nearer to 0 is used
constexpr double kMirrored = 0.7;

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
      const double own = a.confidence.empty() ? 1.0 : a.confidence[static_cast<std::size_t>(f) * a.count() + k];
      if (!point.seen || own * point.confidence < least) continue;
      of_a.emplace_back(a.at(f, k));
      of_b.push_back(point.place);
      weights.push_back(own * point.confidence);
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
  if (pairs.weights.size() >= kFewestAlignedPairs && pairs.frames >= kFewestAlignedFrames) return pairs;
  return PairsAt(a, b, offset_s, 1e-6);
}

double FrameStep(const TrackedPoints& points) {
  const auto last = static_cast<std::size_t>(points.frames()) - 1;
  return (points.time_s[last] - points.time_s[0]) / static_cast<double>(last);
}

std::optional<ViewAlignment> AlignFrom(const TrackedPoints& a, const TrackedPoints& b, double offset_s, bool moving,
                                       double most_offset_s) {
  ViewAlignment view;
  view.offset_s = offset_s;
  const double step = FrameStep(a);
  for (int turn = 0;; ++turn) {
    const SeenPairs pairs = PairsOf(a, b, view.offset_s);
    view.pairs = static_cast<int>(pairs.weights.size());
    if (view.pairs < kFewestAlignedPairs || pairs.frames < kFewestAlignedFrames) return std::nullopt;
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

bool ViewAlignment::Mirrored() const { return mirrored_median < kMirrored * median && median > 0.02; }

std::optional<ViewAlignment> AlignViews(const TrackedPoints& a, const TrackedPoints& b, double most_offset_s) {
  if (a.frames() < kFewestAlignedFrames || b.frames() < kFewestAlignedFrames || a.count() != b.count())
    return std::nullopt;
  std::optional<ViewAlignment> best = AlignFrom(a, b, 0.0, false, most_offset_s);
  std::vector<ViewAlignment> found;
  for (const ClockOffset& offset : CorrelateSpeeds(a, b, most_offset_s)) {
    std::optional<ViewAlignment> view = AlignFrom(a, b, offset.seconds, true, most_offset_s);
    if (!view || !view->offset_known) continue;
    view->correlation = offset.correlation;
    found.push_back(*view);
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
