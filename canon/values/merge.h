#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/store/store.h"

namespace mocurate {

/// One skeleton for all clips: the one that most clips' rotations refer to (of equally many, the first in the order of
/// the clips). Where clips have rest directions of their own, it is the built-in one of that name, if it has that tree.
/// Rest directions are a person's own, like bone lengths. A clip of another tree, or whose rotations refer to another
/// rest pose (a BVH file in an A-pose among T-poses), is removed with a finding "other_skeleton". Frames are not read.
/// There must be a clip.
void UniteSkeletons(Dataset& dataset, std::vector<Finding>& findings);

/// "mixed_rates" for clips of several rates in one set.
void FindMixedRates(const Dataset& dataset, std::vector<Finding>& findings);

/// One of the datasets that are merged.
struct MergePart {
  std::string name;            ///< of its file, for messages and the recipe
  Dataset dataset;             ///< frames of motions are not read and may be absent
  std::string content_sha256;  ///< for the recipe, or empty
  /// Hash of a clip's stored motion; equal motions have equal hashes in every file.
  std::function<Expected<std::string>(std::size_t row)> motion_hash;
};

struct MergedDataset {
  Dataset dataset;
  std::vector<std::pair<std::size_t, std::size_t>> origins;  ///< of each clip: its part, and its row there
  /// A clip's index, and another part and row that has it.
  std::vector<std::pair<std::size_t, std::pair<std::size_t, std::size_t>>> repeats;
  /// "repeated_clip" (info) for each clip of several parts, "mixed_rates", "split_incomplete" for clips in no part of a
  /// split, "split_part_differs" for a repeated clip in two parts of a split, "split_leak" (error). Also in the
  /// dataset.
  std::vector<Finding> findings;
};

/// The clips of several datasets as one, sorted by id; equal clips of several datasets are kept once. Labels and fine
/// labels are united by name: those of the first keep their indices, new ones follow in their order. Splits of one name
/// are united and checked again for leaks: for equal content, and for each type of group (person, style, performance)
/// that every part's own split separates. Error kInconsistent naming the files: rotations and joints only, axes, trees
/// or rest poses that differ; one id with different motions, labels or segments; one fine label of two classes.
Expected<MergedDataset> MergeDatasets(const std::vector<MergePart>& parts);

}  // namespace mocurate
