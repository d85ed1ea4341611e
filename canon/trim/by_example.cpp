#include "canon/trim/by_example.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "canon/trim/body_description.h"
#include "core/base/median.h"

namespace mocurate {
namespace {

constexpr double kExampleRateHz = 12.5;
constexpr double kExampleSmoothingS = 0.1;
constexpr double kExampleVelocityS = 0.3;  // seconds of movement with the weight of a pose difference
constexpr double kEvenDistance = 0.28;     // of a span that is correct with probability 0.5
constexpr double kSteepness = 7.6;

/// Mean length of the bones, metres.
double BoneScale(const Motion& motion) {
  double sum = 0.0;
  int count = 0;
  const int step = std::max(1, motion.frame_count() / 50);
  for (int f = 0; f < motion.frame_count(); f += step) {
    for (int j = 1; j < motion.joint_count(); ++j) {
      const int parent = motion.skeleton->joints[static_cast<std::size_t>(j)].parent;
      sum += (motion.joints.at(f, j) - motion.joints.at(f, parent)).norm();
      ++count;
    }
  }
  return count > 0 && sum > 0.0 ? sum / count : 1.0;
}

/// Rows are samples.
SampleMatrix ExampleFeatures(const Motion& motion) {
  const BodyDescription body = DescribeBody(motion, kExampleRateHz, kExampleSmoothingS);
  const Eigen::Index samples = body.samples(), columns = body.pose.cols();
  SampleMatrix features(samples, 2 * columns);
  features.leftCols(columns) = body.pose;
  for (Eigen::Index s = 0; s < samples; ++s) {
    const Eigen::Index before = std::max<Eigen::Index>(0, s - 1), after = std::min(samples - 1, s + 1);
    features.row(s).rightCols(columns) = kExampleVelocityS * kExampleRateHz /
                                         static_cast<double>(std::max<Eigen::Index>(1, after - before)) *
                                         (body.pose.row(after) - body.pose.row(before));
  }
  return features / (BoneScale(motion) * std::sqrt(static_cast<double>(std::max<Eigen::Index>(1, columns))));
}

/// An alignment of a whole example with samples [begin, end) of a recording.
struct Alignment {
  int begin = 0;
  int end = 0;
  double distance = std::numeric_limits<double>::infinity();  ///< mean over the example's samples
};

/// The best alignment that ends at each sample. Of two steps at most one advances the example or the recording alone,
/// so that a part is half to twice as long as the example.
std::vector<Alignment> AlignExample(const SampleMatrix& example, const SampleMatrix& recording) {
  const int rows = static_cast<int>(example.rows()), columns = static_cast<int>(recording.rows());
  const double none = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd apart(rows, columns);
  for (int j = 0; j < columns; ++j) {
    apart.col(j) = (example.rowwise() - recording.row(j)).rowwise().norm();
  }
  Eigen::MatrixXd cost = Eigen::MatrixXd::Constant(rows, columns, none);
  Eigen::MatrixXi start = Eigen::MatrixXi::Zero(rows, columns);
  for (int j = 0; j < columns; ++j) {
    cost(0, j) = apart(0, j);
    start(0, j) = j;
    for (int i = 1; i < rows; ++i) {
      const auto from = [&](int k, int l, double step) {
        if (l < 0 || k < 0 || cost(k, l) + step >= cost(i, j)) return;
        cost(i, j) = cost(k, l) + step;
        start(i, j) = start(k, l);
      };
      if (j >= 1) from(i - 1, j - 1, apart(i, j));
      if (j >= 2) from(i - 1, j - 2, 0.5 * (apart(i, j - 1) + apart(i, j)));
      if (j >= 1) from(i - 2, j - 1, apart(i - 1, j) + apart(i, j));
    }
  }
  std::vector<Alignment> alignments;
  for (int j = 0; j < columns; ++j) alignments.push_back({start(rows - 1, j), j + 1, cost(rows - 1, j) / rows});
  return alignments;
}

struct SpanCandidate {
  int begin = 0;
  int end = 0;
  double distance = 0.0;  ///< over the median of all parts of the recording
};

/// Alignments with smaller distance than those ending at adjacent samples.
void AddCandidates(const SampleMatrix& example, const SampleMatrix& recording, std::vector<SpanCandidate>& candidates) {
  const std::vector<Alignment> alignments = AlignExample(example, recording);
  std::vector<double> distances;
  for (const Alignment& alignment : alignments) {
    if (std::isfinite(alignment.distance)) distances.push_back(alignment.distance);
  }
  const double usual = std::max(1e-12, Median(distances));
  for (std::size_t j = 0; j < alignments.size(); ++j) {
    const double distance = alignments[j].distance;
    if (!std::isfinite(distance)) continue;
    if (j > 0 && alignments[j - 1].distance < distance) continue;
    if (j + 1 < alignments.size() && alignments[j + 1].distance <= distance) continue;
    candidates.push_back({alignments[j].begin, alignments[j].end, distance / usual});
  }
}

/// Probability that a span at this distance is correct: a logistic regression on its logarithm, fitted to the studio's
/// long sequences with three examples a label (docs/trimming.md).
double ConfidenceAt(double distance) { return 1.0 / (1.0 + std::pow(distance / kEvenDistance, kSteepness)); }

/// The most confident that do not overlap, in order of time.
std::vector<KeptSpan> ChooseSpans(std::vector<SpanCandidate> candidates) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const SpanCandidate& a, const SpanCandidate& b) { return a.distance < b.distance; });
  std::vector<KeptSpan> chosen;
  for (const SpanCandidate& candidate : candidates) {
    const bool overlaps = std::any_of(chosen.begin(), chosen.end(), [&](const KeptSpan& span) {
      return candidate.begin < span.end && span.begin < candidate.end;
    });
    if (!overlaps) chosen.push_back({candidate.begin, candidate.end, "", "", ConfidenceAt(candidate.distance)});
  }
  std::sort(chosen.begin(), chosen.end(), [](const KeptSpan& a, const KeptSpan& b) { return a.begin < b.begin; });
  return chosen;
}

}  // namespace

Expected<std::vector<KeptSpan>> FindByExample(const ByExampleOptions& options, const std::vector<Motion>& examples,
                                              const Motion& recording) {
  std::vector<SampleMatrix> marked;
  for (const Motion& example : examples) {
    if (!SameTree(*example.skeleton, *recording.skeleton)) {
      return Fail(ErrorCode::kInconsistent,
                  "an example has the skeleton '" + example.skeleton->name + "', the recording '" +
                      recording.skeleton->name + "'",
                  "canon.trim.by_example", "mark examples in clips of the same set");
    }
    marked.push_back(ExampleFeatures(example));
    if (marked.back().rows() < 2) marked.pop_back();
  }
  if (marked.empty()) {
    return Fail(ErrorCode::kUsage, "no example of two samples at 12.5 Hz or more", "canon.trim.by_example",
                "mark at least one span of 0.2 s of the action");
  }
  const SampleMatrix features = ExampleFeatures(recording);
  std::vector<SpanCandidate> candidates;
  for (const SampleMatrix& example : marked) AddCandidates(example, features, candidates);
  std::vector<KeptSpan> found;
  for (const KeptSpan& span : ChooseSpans(std::move(candidates))) {
    if (span.confidence < options.min_confidence) continue;
    const bool joins = !found.empty() && (span.begin - found.back().end) / kExampleRateHz < options.join_gap_s;
    if (!joins) {
      found.push_back(span);
      continue;
    }
    found.back().end = span.end;
    found.back().confidence = std::max(found.back().confidence, span.confidence);
  }
  for (KeptSpan& span : found) {
    const auto frame = [&](int sample) {
      return static_cast<int>(std::lround(sample / kExampleRateHz * recording.rate.hz()));
    };
    span.begin = std::min(frame(span.begin), recording.frame_count());
    span.end = std::min(frame(span.end), recording.frame_count());
  }
  return found;
}

Expected<std::vector<KeptSpan>> SpansByExample(const ByExampleOptions& options,
                                               const std::map<std::string, std::vector<Motion>>& examples,
                                               const Motion& recording) {
  std::vector<KeptSpan> spans;
  for (const auto& [label, motions] : examples) {
    auto found = FindByExample(options, motions, recording);
    if (!found) return Forward(found);
    for (KeptSpan& span : *found) span.label = label;
    spans.insert(spans.end(), found->begin(), found->end());
  }
  std::stable_sort(spans.begin(), spans.end(),
                   [](const KeptSpan& a, const KeptSpan& b) { return a.confidence > b.confidence; });
  std::vector<KeptSpan> kept;
  for (KeptSpan& span : spans) {
    const bool overlaps = std::any_of(kept.begin(), kept.end(), [&](const KeptSpan& other) {
      return span.begin < other.end && other.begin < span.end;
    });
    if (!overlaps) kept.push_back(std::move(span));
  }
  std::sort(kept.begin(), kept.end(), [](const KeptSpan& a, const KeptSpan& b) { return a.begin < b.begin; });
  return kept;
}

}  // namespace mocurate
