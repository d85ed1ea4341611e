#include "canon/audit/audit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "canon/frames/facing.h"
#include "core/base/median.h"
#include "core/base/random.h"
#include "core/base/text.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

constexpr int kFrames = 32;               // that a clip is resampled to
constexpr double kVelocityWeight = 3.0;   // of time differences relative to positions
constexpr double kRidge = 0.1;            // added to the kernel's diagonal of ones
constexpr double kNoneShare = 0.15;       // of every class's mean own score that a clip of no class stays below
constexpr double kLeastUsual = 0.05;      // classes with a smaller mean own score are not judged
constexpr std::size_t kMostFolds = 10;    // for distributing persons
constexpr std::uint64_t kDrawnFolds = 5;  // of clips, where there are fewer than three persons

/// Sum of the bone lengths in the middle frame.
double SizeOf(const Motion& motion) {
  const int frame = motion.frame_count() / 2;
  double size = 0.0;
  for (int j = 1; j < motion.joint_count(); ++j) {
    size += (motion.joints.at(frame, j) -
             motion.joints.at(frame, motion.skeleton->joints[static_cast<std::size_t>(j)].parent))
                .norm();
  }
  return size;
}

/// Squared distances (A,B) of the columns of two matrices.
Eigen::MatrixXf SquaredDistances(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b) {
  Eigen::MatrixXf distances = -2.0f * (a.transpose() * b);
  distances.colwise() += a.colwise().squaredNorm().transpose();
  distances.rowwise() += b.colwise().squaredNorm();
  return distances.cwiseMax(0.0f);
}

Eigen::MatrixXf ColumnsOf(const Eigen::MatrixXf& all, const std::vector<int>& which) {
  Eigen::MatrixXf some(all.rows(), static_cast<Eigen::Index>(which.size()));
  for (std::size_t i = 0; i < which.size(); ++i) some.col(static_cast<Eigen::Index>(i)) = all.col(which[i]);
  return some;
}

/// Median squared distance of two clips, from a sample of at most 500.
double MedianDistance(const Eigen::MatrixXf& descriptors) {
  constexpr Eigen::Index kDrawn = 500;
  const Eigen::Index step = std::max<Eigen::Index>(1, descriptors.cols() / kDrawn);
  std::vector<int> drawn;
  for (Eigen::Index i = 0; i < descriptors.cols(); i += step) drawn.push_back(static_cast<int>(i));
  const Eigen::MatrixXf some = ColumnsOf(descriptors, drawn);
  const Eigen::MatrixXf distances = SquaredDistances(some, some);
  std::vector<double> values;
  for (Eigen::Index i = 0; i < distances.rows(); ++i) {
    for (Eigen::Index j = i + 1; j < distances.cols(); ++j) values.push_back(distances(i, j));
  }
  return values.empty() ? 1.0 : std::max(1e-12, Median(std::move(values)));
}

/// Scores (N,C) of each clip by a classifier trained without its fold: kernel ridge regression on one-hot classes. The
/// kernel is Gaussian in the descriptors (D,N), its width the median of their distance. At most `most_clips`
/// training clips are used, drawn at random. `labels` (N) are classes 0 to C-1.
Eigen::MatrixXd OutOfFoldScores(const Eigen::MatrixXf& descriptors, const std::vector<int>& labels,
                                const std::vector<int>& folds, int classes, const LabelNoiseOptions& options) {
  const auto N = static_cast<int>(labels.size());
  const auto scale = static_cast<float>(-1.0 / MedianDistance(descriptors));  // exponent -1 at the median
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(N, classes);
  for (int fold = 0; fold <= *std::max_element(folds.begin(), folds.end()); ++fold) {
    std::vector<int> train, judged;
    for (int i = 0; i < N; ++i) (folds[static_cast<std::size_t>(i)] == fold ? judged : train).push_back(i);
    if (judged.empty() || train.empty()) continue;
    if (train.size() > static_cast<std::size_t>(options.most_clips)) {
      std::vector<std::pair<std::uint64_t, int>> drawn;
      for (const int i : train) drawn.emplace_back(Random(0, "audit.train", std::to_string(i)).Next(), i);
      std::sort(drawn.begin(), drawn.end());
      train.clear();
      for (std::int64_t i = 0; i < options.most_clips; ++i) train.push_back(drawn[static_cast<std::size_t>(i)].second);
    }
    const Eigen::MatrixXf known = ColumnsOf(descriptors, train);
    Eigen::MatrixXd kernel = (SquaredDistances(known, known) * scale).array().exp().matrix().cast<double>();
    kernel.diagonal().array() += kRidge;
    Eigen::MatrixXd targets = Eigen::MatrixXd::Zero(kernel.rows(), classes);
    for (std::size_t i = 0; i < train.size(); ++i) {
      targets(static_cast<Eigen::Index>(i), labels[static_cast<std::size_t>(train[i])]) = 1.0;
    }
    Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> solver(kernel);  // positive definite: a kernel of Gaussians and kRidge
    const Eigen::MatrixXd weights = solver.solve(targets);
    const Eigen::MatrixXf towards = (SquaredDistances(ColumnsOf(descriptors, judged), known) * scale).array().exp();
    const Eigen::MatrixXd answers = towards.cast<double>() * weights;
    for (std::size_t i = 0; i < judged.size(); ++i) scores.row(judged[i]) = answers.row(static_cast<Eigen::Index>(i));
  }
  return scores;
}

/// Confident learning (Northcutt et al. 2021) with margins. A label is suspect where the best other class reaches
/// `other_share` of its mean own score, and the own class stays below `own_share` of its mean own score. `scores` (N,C)
/// are out of fold, from this classifier or another. Classes outside `judged_classes` (empty: all classes are judged),
/// or with a mean own score below 0.05, are neither suspected nor suggested.
std::vector<JudgedLabel> JudgeLabels(const Eigen::MatrixXd& scores, const std::vector<int>& labels,
                                     const LabelNoiseOptions& options, const std::vector<bool>& judged_classes = {}) {
  const auto classes = static_cast<int>(scores.cols());
  std::vector<double> usual(static_cast<std::size_t>(classes), 0.0), count(usual);  // mean own score of a class's clips
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto label = static_cast<std::size_t>(labels[i]);
    usual[label] += scores(static_cast<Eigen::Index>(i), labels[i]);
    count[label] += 1.0;
  }
  std::vector<bool> known(usual.size());
  for (std::size_t c = 0; c < usual.size(); ++c) {
    usual[c] /= std::max(1.0, count[c]);
    known[c] = count[c] > 0.0 && usual[c] >= kLeastUsual && (judged_classes.empty() || judged_classes[c]);
  }
  std::vector<JudgedLabel> judged;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto row = scores.row(static_cast<Eigen::Index>(i));
    JudgedLabel one;
    one.fits_none = known[static_cast<std::size_t>(labels[i])];
    for (int c = 0; c < classes; ++c) {
      const auto at = static_cast<std::size_t>(c);
      if (known[at] && row[c] >= kNoneShare * usual[at]) one.fits_none = false;
      const bool other = c != labels[i] && known[static_cast<std::size_t>(c)];
      if (other && (one.suggested < 0 || row[c] > row[one.suggested])) one.suggested = c;
    }
    if (one.suggested >= 0) {
      one.margin = row[labels[i]] - row[one.suggested];
      one.suspect = row[one.suggested] >= options.other_share * usual[static_cast<std::size_t>(one.suggested)] &&
                    row[labels[i]] < options.own_share * usual[static_cast<std::size_t>(labels[i])] &&
                    one.margin < 0.0 && known[static_cast<std::size_t>(labels[i])];
    }
    judged.push_back(one);
  }
  return judged;
}

}  // namespace

Eigen::VectorXf LabelDescriptor(const Motion& motion) {
  Motion positions;
  positions.skeleton = motion.skeleton;
  positions.rate = motion.rate;
  positions.joints = motion.joints;
  const int T = kFrames, J = motion.joint_count();
  const Motion sampled = ResampleToCount(positions, T);
  const double size = std::max(1e-6, SizeOf(motion));
  const Expected<Heading> heading = HeadingOfFrame(positions, 0, FacingOptions());
  const Matrix3d turn = (heading ? Eigen::AngleAxisd(-heading->yaw, Vector3d::UnitY()) : Eigen::AngleAxisd::Identity())
                            .toRotationMatrix();
  const Eigen::Index width = Eigen::Index{3} * J;
  Eigen::MatrixXf frames(width, T);
  for (int t = 0; t < T; ++t) {
    const Vector3d root = sampled.joints.at(t, 0);
    for (int j = 0; j < J; ++j) {
      const Vector3d from = j == 0 ? Vector3d(sampled.joints.at(0, 0)) : root;
      frames.block<3, 1>(Eigen::Index{3} * j, t) = (turn * (sampled.joints.at(t, j) - from) / size).cast<float>();
    }
  }
  const Eigen::Index places = frames.size(), steps = width * (T - 1);
  Eigen::VectorXf descriptor(places + steps);
  descriptor.head(places) =
      Eigen::Map<const Eigen::VectorXf>(frames.data(), places) / std::sqrt(static_cast<float>(places));
  const Eigen::MatrixXf differences = frames.rightCols(T - 1) - frames.leftCols(T - 1);
  descriptor.tail(steps) = static_cast<float>(kVelocityWeight / std::sqrt(static_cast<double>(steps))) *
                           Eigen::Map<const Eigen::VectorXf>(differences.data(), steps);
  return descriptor;
}

std::vector<int> FoldsByPerson(const Dataset& dataset, const std::vector<int>& rows) {
  std::map<std::string, int> persons;
  for (const int row : rows) persons.emplace(dataset.clips[static_cast<std::size_t>(row)].identity.person, 0);
  std::vector<int> folds;
  if (persons.size() < 3) {
    for (const int row : rows) {
      Random random(0, "audit.fold", dataset.clips[static_cast<std::size_t>(row)].id());
      folds.push_back(static_cast<int>(random.Below(kDrawnFolds)));
    }
    return folds;
  }
  std::vector<std::pair<std::uint64_t, std::string>> order;
  for (const auto& [person, fold] : persons) {
    order.emplace_back(Random(0, "audit.fold", person).Next(), person);
  }
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) persons[order[i].second] = static_cast<int>(i % kMostFolds);
  for (const int row : rows) folds.push_back(persons[dataset.clips[static_cast<std::size_t>(row)].identity.person]);
  return folds;
}

LabelAudit AuditLabels(const Dataset& dataset, const LabelNoiseOptions& options) {
  LabelAudit audit;
  std::vector<int> labels;
  std::vector<bool> there(dataset.labels.size(), false);
  for (std::size_t row = 0; row < dataset.clips.size(); ++row) {
    const Clip& clip = dataset.clips[row];
    const int label = dataset.LabelIndex(clip.label);
    if (label < 0 || !clip.motion || clip.motion->frame_count() < 2) continue;
    audit.rows.push_back(static_cast<int>(row));
    labels.push_back(label);
    there[static_cast<std::size_t>(label)] = true;
  }
  if (std::count(there.begin(), there.end(), true) < 2 || labels.size() < 4) return LabelAudit();
  Eigen::MatrixXf descriptors;
  for (std::size_t i = 0; i < audit.rows.size(); ++i) {
    const Clip& clip = dataset.clips[static_cast<std::size_t>(audit.rows[i])];
    const Eigen::VectorXf one = LabelDescriptor(*clip.motion);
    if (i == 0) descriptors.resize(one.size(), static_cast<Eigen::Index>(audit.rows.size()));
    descriptors.col(static_cast<Eigen::Index>(i)) = one;
  }
  const std::vector<int> folds = FoldsByPerson(dataset, audit.rows);
  const auto classes = static_cast<int>(dataset.labels.size());
  const Eigen::MatrixXd scores = OutOfFoldScores(descriptors, labels, folds, classes, options);
  // A class that occurs in one fold only is never trained when that fold is scored.
  std::vector<std::set<int>> folds_of(dataset.labels.size());
  for (std::size_t i = 0; i < labels.size(); ++i) folds_of[static_cast<std::size_t>(labels[i])].insert(folds[i]);
  std::vector<bool> judged(dataset.labels.size());
  for (std::size_t c = 0; c < judged.size(); ++c) {
    judged[c] = folds_of[c].size() > 1;
    if (there[c] && !judged[c]) audit.unchecked.push_back(dataset.labels[c]);
  }
  audit.judged = JudgeLabels(scores, labels, options, judged);
  return audit;
}

Expected<LabelAudit> AuditLabelsBy(const FeatureSet& features, const Dataset& dataset,
                                   const LabelNoiseOptions& options) {
  const auto C = static_cast<std::size_t>(features.class_count());
  std::map<std::string, Eigen::VectorXd> sum;  // of probabilities, by clip
  for (std::size_t n = 0; n < features.clip.size(); ++n) {
    const Eigen::Map<const Eigen::VectorXf> logits(features.logits.data() + n * C, static_cast<Eigen::Index>(C));
    const Eigen::VectorXd powers = (logits.cast<double>().array() - static_cast<double>(logits.maxCoeff())).exp();
    Eigen::VectorXd& of_clip = sum[features.clip[n]];
    if (of_clip.size() == 0) of_clip = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(C));
    of_clip += powers / powers.sum();
  }
  LabelAudit audit;
  std::vector<int> labels;
  std::vector<Eigen::VectorXd> rows;
  for (std::size_t row = 0; row < dataset.clips.size(); ++row) {
    const Clip& clip = dataset.clips[row];
    const auto found = sum.find(clip.id());
    const int label = dataset.LabelIndex(clip.label);
    if (found == sum.end() || label < 0 || !clip.motion) continue;
    Eigen::VectorXd scores = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(dataset.labels.size()));
    for (std::size_t c = 0; c < C; ++c) {
      const int own = dataset.LabelIndex(features.classes[c]);
      if (own >= 0) scores[own] += found->second[static_cast<Eigen::Index>(c)];
    }
    if (!(scores.sum() > 0.0)) continue;
    rows.push_back(scores / scores.sum());
    labels.push_back(label);
    audit.rows.push_back(static_cast<int>(row));
  }
  if (rows.empty()) {
    const std::string theirs = features.clip.empty() ? "none" : features.clip.front();
    const std::string ours = dataset.clips.empty() ? "none" : dataset.clips.front().id();
    return Fail(ErrorCode::kInconsistent,
                "no clip has probabilities for its labels; of " + std::to_string(features.clip.size()) +
                    " clips the first is '" + theirs + "', the dataset's first is '" + ours + "'",
                "probabilities",
                "use features/SET.h5 of this dataset: mocurate eval --protocol own --extractor CHECKPOINT --generated "
                "DATASET -o FOLDER");
  }
  Eigen::MatrixXd scores(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(dataset.labels.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) scores.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  audit.judged = JudgeLabels(scores, labels, options);
  return audit;
}

}  // namespace mocurate
