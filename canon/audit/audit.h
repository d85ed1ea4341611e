#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "canon/options.h"
#include "core/base/finding.h"
#include "core/store/feature_file.h"
#include "core/store/store.h"

namespace mocurate {

/// Two clips in two parts of a split: "train", "validation", "test".
struct SplitParts {
  std::string split, part, other;
};

/// A finding of an audit and its suggestion: another label, the other clip of a pair, or nothing.
struct AuditFinding {
  Finding finding;
  std::string suggested;
  /// A redundant clip: it repeats another of the same person, labels, segments and part of every split, with rotations
  /// and joints equal to 0.01 mm.
  std::string safe_to_drop;
  std::vector<SplitParts> parts;  ///< of a leak: where the clip and the suggested one are
};

/// Clips whose motion is wrong: "mirrored" (the anatomy of a left-handed frame, MeasureHandedness), "swapped_sides"
/// (FindSwaps), "frozen_frames" (FindRepeats), the last two with their frames.
std::vector<AuditFinding> FindClipErrors(const Dataset& dataset);

/// Pairs of clips with the same motion (FindDuplicates), also mirrored or in part, or of the same
/// source data (ContentsOf): "leak" (error) where a split has them in two parts, else "duplicate". `suggested` is the
/// other clip. Of more than two clips with the same source data, each is a pair with the first one and with the first
/// one in each other part.
std::vector<AuditFinding> FindRepeatedClips(const Dataset& dataset, double distance = 0.004);

/// Errors of a dataset as a whole. "class_not_trained": a split tests a class that it does not train. "names_alike":
/// names of two persons that differ in case or blanks only; a split by person would separate them. "split_leak"
/// (error): a person, style or performance is in two parts of a split that keeps them apart by its rule, with a clip of
/// either part; a warning for all persons of a split whose rule is unknown. The others are without a clip.
std::vector<AuditFinding> FindSetErrors(const Dataset& dataset);

/// One number about a clip, defined alike for all clips of a dataset.
struct MeasureKind {
  const char* name;
  const char* unit;
  /// Which side of its class is an outlier: +1 the high one, -1 the low one, 0 both.
  int side;
  double grain;                       ///< differences below it are ignored, in the measure's unit
  double (*value)(const Clip& clip);  ///< NaN where a clip does not have it
};

/// In the order of their columns: seconds, jerk, foot_skate, floor_penetration, bone_spread, limit_share, top_speed,
/// observed_share, fit_rms.
const std::vector<MeasureKind>& MeasuresOfClips();

/// (clips, measures); NaN where a clip does not have one.
std::vector<std::vector<double>> MeasureClips(const Dataset& dataset);

/// "outlier" (info): clips with a measure further from the median of its class than `options.deviations` robust
/// standard deviations. Measures without an upper bound are compared on a logarithmic scale above their grain. Listed
/// is the worst measure of a clip, the furthest clips first. Classes of fewer than eight are compared
/// with the whole set.
std::vector<AuditFinding> FindOutliers(const Dataset& dataset, const std::vector<std::vector<double>>& measures,
                                       const OutlierOptions& options);

/// Nearest-neighbour recognition without training, a baseline for every recogniser: joints relative to the root of
/// frame 0, divided by the clip's extent, resampled linearly to 32 frames, Euclidean distance. Each test clip
/// gets the label of the nearest training clip.
struct NearestNeighbourResult {
  int correct = 0;
  int count = 0;
  double accuracy() const { return count == 0 ? 0.0 : static_cast<double>(correct) / count; }
};

NearestNeighbourResult NearestNeighbour(const Dataset& dataset, const Split& split);

/// Descriptor (D) of a motion for the judgement of labels and the map: joints relative to the root of each frame and
/// the root's path, without the heading of the first frame, divided by the skeleton's size, resampled to 32 frames; and
/// their weighted time differences. The heading is that of the hips where the skeleton names them.
Eigen::VectorXf LabelDescriptor(const Motion& motion);

/// A picture of a set: clips (N) that have a motion, their places in the two first principal components of
/// LabelDescriptor, and for each the rows of the nearest others by its 24 first components. Empty below three clips.
struct ClipMap {
  std::vector<int> rows;
  std::vector<Eigen::Vector2f> places;
  std::vector<std::vector<int>> nearest;
};
ClipMap MapClips(const Dataset& dataset, std::size_t neighbours);

/// Folds of clips, no person in two: persons are distributed over at most ten. With fewer than three persons,
/// clips are drawn into five. (N)
std::vector<int> FoldsByPerson(const Dataset& dataset, const std::vector<int>& rows);

/// Whether the label of a clip is suspect, and by how much.
struct JudgedLabel {
  double margin = 0.0;  ///< score of its own class minus the best other one; sorted ascending
  int suggested = -1;   ///< that other class
  bool suspect = false;
  bool fits_none = false;  ///< every class scores less than 15 % of its mean own score
};

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
