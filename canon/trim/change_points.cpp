#include "canon/trim/trim.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "canon/trim/body_description.h"
#include "core/base/median.h"

namespace mocurate {
namespace {

/// Distance of a body from rest.
struct Unrest {
  bool rests = false;     ///< whether there is a rest posture
  Eigen::VectorXd value;  ///< (S) sqrt((distance from the rest posture / 0.1 m)^2 + (movement / 0.15 m/s)^2), about 1
                          ///< and less at rest; the largest number throughout where there is no rest posture
};

constexpr double kSlow = 0.6;             // m/s of the fastest joint: above a tracker's noise, below strides
constexpr double kStill = 0.4;            // m/s, scale of stillness for slow movement
constexpr double kMomentGapS = 0.5;       // between two still moments
constexpr double kMomentS = 0.6;          // maximum counted time of one moment
constexpr double kLeastRestS = 0.6;       // minimum score of a rest posture
constexpr double kLeastRestShare = 0.06;  // minimum share of the time away from it
constexpr int kCandidates = 300;
constexpr double kPostureScale = 0.1;    // metres
constexpr double kMovementScale = 0.15;  // m/s

/// A slow sample that represents `weight_s` seconds of its moment.
struct StillSample {
  Eigen::Index sample = 0;
  std::size_t moment = 0;
  double weight_s = 0.0;
};

std::vector<StillSample> StillSamples(const BodyDescription& body) {
  std::vector<Eigen::Index> slow;
  for (Eigen::Index s = 0; s < body.samples(); ++s) {
    if (body.movement(s) < kSlow) slow.push_back(s);
  }
  const std::size_t every = std::max<std::size_t>(1, slow.size() / kCandidates);
  std::vector<StillSample> still;
  std::size_t moment = 0;
  for (std::size_t i = 0; i < slow.size(); ++i) {
    if (i > 0 && static_cast<double>(slow[i] - slow[i - 1]) > kMomentGapS * body.rate_hz) ++moment;
    const double speed = body.movement(slow[i]) / kStill;
    const double weight_s = std::exp(-0.5 * speed * speed) * static_cast<double>(every) / body.rate_hz;
    if (i % every == 0) still.push_back({slow[i], moment, weight_s});
  }
  return still;
}

/// The posture (3 J) in which a recording is still most often: the one with the largest sum, over separate still
/// moments, of the time spent near it weighted by slowness, at most 0.6 s of each. A posture held once, however long,
/// is one moment. Nothing where that sum is below 0.6 s or 6 % of the time away from it: the body is never at rest.
std::optional<Eigen::RowVectorXd> RestPosture(const BodyDescription& body) {
  const std::vector<StillSample> still = StillSamples(body);
  const double duration_s = static_cast<double>(body.samples()) / body.rate_hz;
  std::optional<Eigen::RowVectorXd> posture;
  double most = 0.0;
  for (const StillSample& candidate : still) {
    double score = 0.0, near_s = 0.0, moment_s = 0.0;
    for (std::size_t i = 0; i < still.size(); ++i) {
      const double off = PoseDistance(body.pose.row(candidate.sample), body.pose.row(still[i].sample)) / kPostureScale;
      moment_s += still[i].weight_s * std::exp(-0.5 * off * off);
      if (i + 1 < still.size() && still[i + 1].moment == still[i].moment) continue;
      score += std::min(moment_s, kMomentS);
      near_s += moment_s;
      moment_s = 0.0;
    }
    if (score <= most) continue;
    most = score;
    const bool rests = score >= kLeastRestS && score >= kLeastRestShare * (duration_s - near_s);
    posture = rests ? std::optional<Eigen::RowVectorXd>(body.pose.row(candidate.sample)) : std::nullopt;
  }
  return posture;
}

Unrest MeasureUnrest(const BodyDescription& body) {
  const auto posture = RestPosture(body);
  Unrest unrest;
  unrest.rests = posture.has_value();
  unrest.value.setConstant(body.samples(), std::numeric_limits<double>::max());
  for (Eigen::Index s = 0; posture && s < body.samples(); ++s) {
    unrest.value(s) =
        std::hypot(PoseDistance(body.pose.row(s), *posture) / kPostureScale, body.movement(s) / kMovementScale);
  }
  return unrest;
}

constexpr double kChangeRateHz = 25.0;
constexpr double kChangeSmoothingS = 0.1;
constexpr double kKernelWidth = 0.2;     // of the description, in metres per joint
constexpr double kPoseSmoothingS = 0.3;  // smoothing of poses and speeds: an action lasts longer than a moment
constexpr double kSpeedSmoothingS = 0.15;
constexpr double kSpeedUnit = 0.05;   // m/s; smaller speeds count as equal
constexpr double kSpeedWeight = 0.3;  // metres equivalent to a factor of e in speed
constexpr double kRestWeight = 0.2;   // metres equivalent to being at rest
constexpr double kRestSmoothingS = 0.08;
constexpr double kMostUnrest = 2.0;
constexpr double kFarFromRest = 6.0;  // distance from rest above which a boundary has the full penalty
constexpr double kRestUnrest = 1.2;   // median of a segment that is a rest
constexpr double kEvidenceS = 10.0;   // of each side of a boundary, for its confidence

/// Input of change point detection. Rows are samples.
struct ChangeDescription {
  SampleMatrix features;  ///< distances between rows are those of the kernel, in units of its width
  Unrest unrest;
};

ChangeDescription DescribeChanges(const Motion& motion) {
  const BodyDescription body = DescribeBody(motion, kChangeRateHz, kChangeSmoothingS);
  ChangeDescription description;
  description.unrest = MeasureUnrest(body);
  const Eigen::Index samples = body.samples(), joints = body.joints();
  const double share = 1.0 / std::sqrt(static_cast<double>(std::max<Eigen::Index>(1, joints)));
  const SampleMatrix speeds = SmoothRows(body.speed, kSpeedSmoothingS * kChangeRateHz);
  const SampleMatrix effort = (speeds.array() / kSpeedUnit).log1p().matrix();
  description.features.resize(samples, 4 * joints + 1);
  description.features.leftCols(3 * joints) = share * SmoothRows(body.pose, kPoseSmoothingS * kChangeRateHz);
  description.features.middleCols(3 * joints, joints) =
      kSpeedWeight * share * SmoothRows(effort, kPoseSmoothingS * kChangeRateHz);
  const SampleMatrix unrest = description.unrest.value.cwiseMin(kMostUnrest);
  description.features.rightCols(1) = kRestWeight / kMostUnrest * SmoothRows(unrest, kRestSmoothingS * kChangeRateHz);
  description.features /= kKernelWidth;
  return description;
}

double SampleKernel(const SampleMatrix& features, Eigen::Index a, Eigen::Index b) {
  return std::exp(-0.5 * (features.row(a) - features.row(b)).squaredNorm());
}

/// Decrease of the scatter of samples [a, c), in seconds, when they are split at b.
double GainOfSplit(const SampleMatrix& features, int a, int b, int c) {
  const int most = static_cast<int>(kEvidenceS * kChangeRateHz);
  a = std::max(a, b - most);
  c = std::min(c, b + most);
  if (a >= b || b >= c) return 0.0;
  double left = 0.0, right = 0.0, across = 0.0;
  for (int i = a; i < c; ++i) {
    for (int j = i; j < c; ++j) {
      const double both = (i == j ? 1.0 : 2.0) * SampleKernel(features, i, j);
      (j < b ? left : i >= b ? right : across) += both;
    }
  }
  const double all = left + right + across;
  return (left / (b - a) + right / (c - b) - all / (c - a)) / kChangeRateHz;
}

/// Cost in seconds of a boundary before each sample.
Eigen::VectorXd BoundaryPenalties(const ChangePointOptions& options, const Unrest& unrest) {
  const Eigen::Index samples = unrest.value.size();
  if (!unrest.rests) return Eigen::VectorXd::Constant(samples, options.restless_penalty_s);
  Eigen::VectorXd penalties(samples);
  for (Eigen::Index s = 0; s < samples; ++s) {
    const Eigen::Index begin = std::max<Eigen::Index>(0, s - 1);
    const double least = unrest.value.segment(begin, std::min(samples, s + 2) - begin).minCoeff();
    const double far = std::clamp((least - 1.0) / (kFarFromRest - 1.0), 0.0, 1.0);
    penalties(s) = options.rest_penalty_s + far * (options.moving_penalty_s - options.rest_penalty_s);
  }
  return penalties;
}

/// First samples of the segments after the first.
std::vector<int> BestCuts(const ChangePointOptions& options, const SampleMatrix& features,
                          const Eigen::VectorXd& penalties) {
  const int samples = static_cast<int>(features.rows());
  const int least = std::max(1, static_cast<int>(options.least_segment_s * kChangeRateHz));
  const int longest = std::max(2 * least, static_cast<int>(options.longest_s * kChangeRateHz));
  std::vector<double> best(static_cast<std::size_t>(samples) + 1, std::numeric_limits<double>::infinity());
  std::vector<int> from(static_cast<std::size_t>(samples) + 1, 0);
  std::vector<double> similar(static_cast<std::size_t>(samples), 0.0);  // sum of the kernel over [s, end) x [s, end)
  best[0] = 0.0;
  for (int end = 1; end <= samples; ++end) {
    const int first = std::max(0, end - longest);
    double with_last = 0.0;
    for (int s = end - 1; s >= first; --s) {
      with_last += (s == end - 1 ? 0.5 : 1.0) * SampleKernel(features, s, end - 1);
      double& sum = similar[static_cast<std::size_t>(s)];
      sum += 2.0 * with_last;
      const int length = end - s;
      if (length < least && end < samples) continue;
      const double scatter = (length - sum / length) / kChangeRateHz;
      const double cost = best[static_cast<std::size_t>(s)] + scatter + (s > 0 ? penalties(s) : 0.0);
      if (cost < best[static_cast<std::size_t>(end)]) {
        best[static_cast<std::size_t>(end)] = cost;
        from[static_cast<std::size_t>(end)] = s;
      }
    }
  }
  std::vector<int> cuts;
  for (int s = from[static_cast<std::size_t>(samples)]; s > 0; s = from[static_cast<std::size_t>(s)]) cuts.push_back(s);
  std::reverse(cuts.begin(), cuts.end());
  return cuts;
}

/// Samples [begin, end).
struct CutPiece {
  int begin = 0;
  int end = 0;
  bool rest = false;
  double at = 0.0;        ///< sample of the boundary at its begin, between two samples
  double evidence = 0.0;  ///< decrease at that boundary divided by its penalty
};

bool IsRest(const Eigen::VectorXd& unrest, int begin, int end) {
  return Median({unrest.data() + begin, unrest.data() + end}) < kRestUnrest;
}

/// Pieces between cuts. Adjacent rests are merged; cuts made only for options.longest_s are removed.
std::vector<CutPiece> PiecesBetween(const ChangePointOptions& options, const std::vector<int>& cuts,
                                    const ChangeDescription& description, const Eigen::VectorXd& penalties) {
  const int samples = static_cast<int>(description.features.rows());
  const int longest = static_cast<int>(options.longest_s * kChangeRateHz) - 1;
  std::vector<CutPiece> pieces;
  for (std::size_t i = 0; i <= cuts.size(); ++i) {
    CutPiece piece;
    piece.begin = i == 0 ? 0 : cuts[i - 1];
    piece.end = i == cuts.size() ? samples : cuts[i];
    piece.rest = IsRest(description.unrest.value, piece.begin, piece.end);
    piece.at = piece.begin - 0.5;
    if (i > 0) {
      CutPiece& before = pieces.back();
      const double gain = GainOfSplit(description.features, before.begin, piece.begin, piece.end);
      piece.evidence = gain / penalties(piece.begin);
      const bool forced = std::max(piece.end - piece.begin, before.end - before.begin) >= longest;
      if ((before.rest && piece.rest) || (forced && piece.evidence < 1.0)) {
        before.end = piece.end;
        continue;
      }
    }
    pieces.push_back(piece);
  }
  return pieces;
}

/// A short rest within the recording becomes one boundary in its middle.
std::vector<CutPiece> WithoutShortRests(const ChangePointOptions& options, const std::vector<CutPiece>& pieces) {
  std::vector<CutPiece> kept;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const CutPiece& piece = pieces[i];
    const bool within = i > 0 && i + 1 < pieces.size();
    if (!piece.rest || !within || (piece.end - piece.begin) / kChangeRateHz >= options.least_rest_s) {
      kept.push_back(piece);
      continue;
    }
    CutPiece next = pieces[++i];
    next.at = 0.5 * (piece.begin + piece.end) - 0.5;
    next.evidence = std::min(piece.evidence, next.evidence);
    kept.push_back(next);
  }
  return kept;
}

/// Probability of a true boundary at this ratio to the penalty: a logistic regression on its logarithm, fitted to the
/// studio's long sequences and to joined clips of KARD and Bandai 1 (docs/trimming.md).
double BoundaryConfidence(double evidence) {
  const double odds = 0.5 * evidence * evidence;
  return odds / (1.0 + odds);
}

}  // namespace

std::vector<ProposedSegment> ProposeSegments(const ChangePointOptions& options, const Motion& motion) {
  const int frames = motion.frame_count();
  if (frames == 0) return {};
  const ChangeDescription description = DescribeChanges(motion);
  const Eigen::VectorXd penalties = BoundaryPenalties(options, description.unrest);
  const std::vector<int> cuts = BestCuts(options, description.features, penalties);
  const std::vector<CutPiece> pieces = WithoutShortRests(options, PiecesBetween(options, cuts, description, penalties));
  std::vector<ProposedSegment> segments;
  for (const CutPiece& piece : pieces) {
    ProposedSegment segment;
    segment.rest = piece.rest;
    if (!segments.empty() && BoundaryConfidence(piece.evidence) < options.min_confidence) {
      segments.back().rest = segments.back().rest && piece.rest;
      continue;
    }
    if (!segments.empty()) {
      segment.begin = std::clamp(static_cast<int>(std::lround(piece.at / kChangeRateHz * motion.rate.hz())),
                                 segments.back().begin + 1, frames - 1);
      segment.confidence = BoundaryConfidence(piece.evidence);
      segments.back().end = segment.begin;
    }
    segments.push_back(segment);
  }
  segments.back().end = frames;
  return segments;
}

}  // namespace mocurate
