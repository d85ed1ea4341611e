#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "canon/options.h"
#include "core/store/feature_file.h"
#include "core/store/store.h"

namespace mocurate {

/// Descriptor (D) of a clip for the kernel classifier: joints relative to the root of each frame and the root's path,
/// without the heading of the first frame, divided by the skeleton's size, resampled; and their weighted time
/// differences. The heading is that of the hips where the skeleton names them.
Eigen::VectorXf LabelDescriptor(const Motion& motion);

/// Folds of clips, no person in two: persons are distributed over at most ten. With fewer than three persons,
/// clips are drawn into five. (N)
std::vector<int> FoldsByPerson(const Dataset& dataset, const std::vector<int>& rows);

/// Scores (N,C) of each clip by a classifier trained without its fold: kernel ridge regression on one-hot classes. The
/// kernel is Gaussian in the descriptors (D,N), its width the median of their distance. At most `most_clips`
/// training clips are used, drawn at random. `labels` (N) are classes 0 to C-1.
Eigen::MatrixXd OutOfFoldScores(const Eigen::MatrixXf& descriptors, const std::vector<int>& labels,
                                const std::vector<int>& folds, int classes, const LabelNoiseOptions& options);

/// Whether the label of a clip is suspect, and by how much.
struct JudgedLabel {
  double margin = 0.0;  ///< score of its own class minus the best other one; sorted ascending
  int suggested = -1;   ///< that other class
  bool suspect = false;
  bool fits_none = false;  ///< every class scores less than 15 % of its mean own score
};

/// Confident learning (Northcutt et al. 2021) with margins. A label is suspect where the best other class reaches
/// `other_share` of its mean own score, and the own class stays below `own_share` of its mean own score. `scores` (N,C)
/// are out of fold, from this classifier or another. Classes outside `judged_classes` (empty: all classes are judged),
/// or with a mean own score below 0.05, are neither suspected nor suggested.
std::vector<JudgedLabel> JudgeLabels(const Eigen::MatrixXd& scores, const std::vector<int>& labels,
                                     const LabelNoiseOptions& options, const std::vector<bool>& judged_classes = {});

/// Judged rows of a dataset with more than one class; all empty where there is nothing to compare (fewer than two
/// classes or four clips).
struct LabelAudit {
  std::vector<int> rows;               ///< of the dataset
  std::vector<JudgedLabel> judged;     ///< of each
  std::vector<std::string> unchecked;  ///< classes performed by a single person
};
LabelAudit AuditLabels(const Dataset& dataset, const LabelNoiseOptions& options);
/// The same from another classifier's logits, their mean over passes. Error kInconsistent where the features match no
/// clip of the dataset, or none of its labels.
Expected<LabelAudit> AuditLabelsBy(const FeatureSet& features, const Dataset& dataset,
                                   const LabelNoiseOptions& options);

}  // namespace mocurate
