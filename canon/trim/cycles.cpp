#include "canon/trim/trim.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "canon/trim/body_description.h"

namespace mocurate {
namespace {

constexpr double kCycleRateHz = 25.0;
constexpr double kCycleSmoothingS = 0.05;
constexpr double kCycleVelocityS = 0.15;   // seconds of movement with the weight of a pose difference
constexpr double kMovingShare = 0.15;      // of the 90th percentile of the movement
constexpr double kLeastMoving = 0.15;      // m/s
constexpr double kLeastRepetitions = 1.8;  // minimum number of periods in the moving part
constexpr double kAgreeing = 0.5;          // of the pairs of samples at a lag
constexpr double kDip = 0.5;               // of the largest distance at shorter lags
constexpr double kNearlyBest = 0.05;       // maximum excess distance of a shorter period over the best one
constexpr double kTempo = 4.0;             // cost of a repetition e times as long as the period
constexpr double kMostTempo = 1.7;         // times longer or shorter than the period

/// Samples [begin, end) in which the body moves, with their features.
struct MovingPart {
  int begin = 0;
  int end = 0;
  SampleMatrix features;  ///< of this part only
  double scale = 1.0;     ///< mean squared distance of two unrelated samples
};

std::optional<MovingPart> FindMovingPart(const BodyDescription& body) {
  std::vector<double> sorted(body.movement.begin(), body.movement.end());
  if (sorted.size() < 2) return std::nullopt;
  std::sort(sorted.begin(), sorted.end());
  const double usual = sorted[static_cast<std::size_t>(0.9 * static_cast<double>(sorted.size() - 1))];
  const double least = std::max(kLeastMoving, kMovingShare * usual);
  MovingPart part;
  part.begin = 0;
  part.end = body.samples();
  while (part.begin < part.end && body.movement(part.begin) < least) ++part.begin;
  while (part.end > part.begin && body.movement(part.end - 1) < least) --part.end;
  const int count = part.end - part.begin;
  if (count < 2) return std::nullopt;
  const Eigen::Index columns = body.pose.cols();
  part.features.resize(count, 2 * columns);
  part.features.leftCols(columns) = body.pose.middleRows(part.begin, count);
  for (int s = 0; s < count; ++s) {
    const int before = std::max(0, part.begin + s - 1), after = std::min(body.samples() - 1, part.begin + s + 1);
    part.features.row(s).rightCols(columns) =
        kCycleVelocityS * kCycleRateHz / (after - before) * (body.pose.row(after) - body.pose.row(before));
  }
  const Eigen::RowVectorXd mean = part.features.colwise().mean();
  part.scale = std::max(1e-12, 2.0 * (part.features.rowwise() - mean).rowwise().squaredNorm().mean());
  return part;
}

/// Distance of the part from itself at each lag in samples, 0 to `most`, over the half of the pairs that agree best, so
/// that movements before and after the repetitions do not hide them.
std::vector<double> LagDistances(const MovingPart& part, int most) {
  std::vector<double> distances(static_cast<std::size_t>(most) + 1, 0.0);
  const Eigen::Index count = part.features.rows();
  for (int lag = 1; lag <= most; ++lag) {
    const Eigen::Index pairs = count - lag;
    const Eigen::VectorXd apart =
        (part.features.topRows(pairs) - part.features.bottomRows(pairs)).rowwise().squaredNorm();
    std::vector<double> sorted(apart.begin(), apart.end());
    std::sort(sorted.begin(), sorted.end());
    const std::size_t kept = std::max<std::size_t>(1, static_cast<std::size_t>(kAgreeing * static_cast<double>(pairs)));
    double sum = 0.0;
    for (std::size_t k = 0; k < kept; ++k) sum += sorted[k];
    distances[static_cast<std::size_t>(lag)] = sum / static_cast<double>(kept) / part.scale;
  }
  return distances;
}

struct CyclePeriod {
  int lag = 0;          ///< samples; 0: the part is not periodic
  double ratio = 1.0;   ///< distance at the lag over the largest of shorter lags; without a period, the smallest ratio
  double distance = 0;  ///< at the lag
};

CyclePeriod FindPeriod(const CycleOptions& options, const MovingPart& part) {
  const int count = static_cast<int>(part.features.rows());
  const int least = std::max(2, static_cast<int>(std::lround(options.shortest_s * kCycleRateHz)));
  const int most =
      std::min(static_cast<int>(options.longest_s * kCycleRateHz), static_cast<int>(count / kLeastRepetitions));
  if (most <= least + 1) return {};
  const std::vector<double> distances = LagDistances(part, most + 1);
  std::vector<CyclePeriod> dips;
  CyclePeriod best;
  double largest = 0.0;
  for (int lag = 1; lag <= most; ++lag) {
    const auto at = [&](int l) { return distances[static_cast<std::size_t>(l)]; };
    largest = std::max(largest, at(lag));
    if (lag < least || at(lag) > at(lag - 1) || at(lag) > at(lag + 1) || largest <= 0.0) continue;
    const CyclePeriod dip{lag, at(lag) / largest, at(lag)};
    if (dip.ratio > kDip) {
      if (best.lag == 0) best.ratio = std::min(best.ratio, dip.ratio);
      continue;
    }
    dips.push_back(dip);
    if (best.lag == 0 || dip.distance < best.distance) best = dip;
  }
  for (const CyclePeriod& dip : dips) {
    if (dip.distance <= best.distance + kNearlyBest) return dip;
  }
  return best;
}

/// Samples of the part where repetitions begin, and its end.
std::vector<int> PlaceBoundaries(const MovingPart& part, int period) {
  const int count = static_cast<int>(part.features.rows());
  const int shortest = std::max(1, static_cast<int>(period / kMostTempo));
  const int longest = static_cast<int>(period * kMostTempo);
  std::vector<double> best(static_cast<std::size_t>(count) + 1, std::numeric_limits<double>::infinity());
  std::vector<int> from(static_cast<std::size_t>(count) + 1, -1);
  best[0] = 0.0;
  for (int end = shortest; end <= count; ++end) {
    for (int begin = std::max(0, end - longest); begin <= end - shortest; ++begin) {
      const double tempo = std::log(static_cast<double>(end - begin) / period);
      double cost = best[static_cast<std::size_t>(begin)] + kTempo * tempo * tempo;
      if (begin > 0 && end < count) {
        cost += (part.features.row(begin) - part.features.row(end)).squaredNorm() / part.scale;
      }
      if (cost < best[static_cast<std::size_t>(end)]) {
        best[static_cast<std::size_t>(end)] = cost;
        from[static_cast<std::size_t>(end)] = begin;
      }
    }
  }
  std::vector<int> boundaries = {count};
  while (boundaries.back() > 0 && from[static_cast<std::size_t>(boundaries.back())] >= 0) {
    boundaries.push_back(from[static_cast<std::size_t>(boundaries.back())]);
  }
  if (boundaries.back() != 0) return {0, count};
  std::reverse(boundaries.begin(), boundaries.end());
  return boundaries;
}

/// Similarity in [0, 1] of the repetitions [a, b) and [b, c), resampled to one length.
double CycleSimilarity(const MovingPart& part, int a, int b, int c) {
  double apart = 0.0;
  const int first = b - a, second = c - b, steps = std::min(first, second);
  for (int k = 0; k < steps; ++k) {
    const double at = (k + 0.5) / steps;
    apart +=
        (part.features.row(a + static_cast<int>(at * first)) - part.features.row(b + static_cast<int>(at * second)))
            .squaredNorm();
  }
  return std::clamp(1.0 - apart / (std::max(1, steps) * part.scale), 0.0, 1.0);
}

}  // namespace

std::vector<KeptSpan> FindCycles(const CycleOptions& options, const Motion& motion) {
  const BodyDescription body = DescribeBody(motion, kCycleRateHz, kCycleSmoothingS);
  const std::optional<MovingPart> part = FindMovingPart(body);
  if (!part) return {};
  const CyclePeriod period = FindPeriod(options, *part);
  std::vector<int> boundaries = {0, part->end - part->begin};
  if (period.lag > 0) boundaries = PlaceBoundaries(*part, period.lag);
  const auto frame = [&](int sample) {
    return std::min(motion.frame_count(),
                    static_cast<int>(std::lround((part->begin + sample) / kCycleRateHz * motion.rate.hz())));
  };
  std::vector<KeptSpan> repetitions;
  for (std::size_t k = 0; k + 1 < boundaries.size(); ++k) {
    KeptSpan repetition{frame(boundaries[k]), frame(boundaries[k + 1]), "", "", period.lag > 0 ? 0.0 : period.ratio};
    if (k > 0) {
      const double similarity = CycleSimilarity(*part, boundaries[k - 1], boundaries[k], boundaries[k + 1]);
      repetition.confidence = std::max(repetition.confidence, similarity);
      repetitions.back().confidence = std::max(repetitions.back().confidence, similarity);
    }
    repetitions.push_back(repetition);
  }
  return repetitions;
}

}  // namespace mocurate
