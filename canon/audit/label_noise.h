#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "canon/options.h"
#include "core/store/feature_file.h"
#include "core/store/store.h"

namespace mocurate {

/// What a clip is to the plain classifier (D): joints from the root of each frame and the root's path, the heading of
/// the first frame taken out, per size of the skeleton, resampled to `frames`; and their differences in time, which
/// count `velocity_weight` times as much. Turned by the hips where the skeleton names them.
Eigen::VectorXf LabelDescriptor(const Motion& motion, const LabelNoiseOptions& options);

/// Folds of clips, no person in two: persons are spread over at most `most_folds`; of fewer than three persons clips
/// are drawn into `drawn_folds`. (N)
std::vector<int> FoldsByPerson(const Dataset& dataset, const std::vector<int>& rows,
                               const LabelNoiseOptions& options = {});

/// Scores (N,C) of each clip by a classifier that never saw its fold: kernel ridge regression on one-hot classes, its
/// kernel Gaussian in the descriptors (D,N), as wide as `width` says in medians of their distance. Of more than
/// `most_clips` training clips so many are drawn. `labels` (N) classes 0 to C-1. Error kConfig for a ridge too small.
Expected<Eigen::MatrixXd> OutOfFoldScores(const Eigen::MatrixXf& descriptors, const std::vector<int>& labels,
                                          const std::vector<int>& folds, int classes, const LabelNoiseOptions& options);

/// Whether the label of a clip is suspect, and how much.
struct JudgedLabel {
  double margin = 0.0;  ///< score of its own class less that of the best other one: the lowest come first
  int suggested = -1;   ///< that other class
  bool suspect = false;
  bool fits_none = false;  ///< every class scores less than `none_share` of what its own clips do
};

/// Confident learning (Northcutt et al. 2021) with margins: a label is suspect where the best other class scores at
/// least `other_share` of what clips labelled so score of it in the mean, and its own less than `own_share` of what
/// clips of its class do. `scores` (N,C) are out of fold, from this classifier or another. Classes that are not among
/// `judged_classes` (empty: all are) or score less than `least_usual` of their own clips are neither suspected nor
/// suggested.
std::vector<JudgedLabel> JudgeLabels(const Eigen::MatrixXd& scores, const std::vector<int>& labels,
                                     const LabelNoiseOptions& options, const std::vector<bool>& judged_classes = {});

/// Rows of labelled clips of a dataset with more than one class, and what is suspect of them; all empty where there is
/// nothing to compare (fewer than two classes or four clips).
struct LabelAudit {
  std::vector<int> rows;               ///< of the dataset
  std::vector<JudgedLabel> judged;     ///< of each
  std::vector<std::string> unchecked;  ///< classes that one person alone performs
};
Expected<LabelAudit> AuditLabels(const Dataset& dataset, const LabelNoiseOptions& options);
/// The same by the logits that another classifier gave the clips, their mean over passes. Error kInconsistent where the
/// features are of no clip of the dataset, or know none of its labels.
Expected<LabelAudit> AuditLabelsBy(const FeatureSet& features, const Dataset& dataset,
                                   const LabelNoiseOptions& options);

}  // namespace mocurate
