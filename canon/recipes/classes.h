#pragma once

#include <set>
#include <string>
#include <vector>

#include "canon/options.h"
#include "core/base/finding.h"
#include "core/store/store.h"

namespace mocurate {

/// Code of the finding about a clip whose label is of no listed class.
inline constexpr const char* kLabelNotListed = "label_not_listed";

/// Class names in the order of their indices, for sets without `assemble.classes`: the names in `order` that a clip
/// has, then the other labels by name.
std::vector<std::string> OrderedLabels(const std::vector<std::string>& order, const std::set<std::string>& present);

/// Checks that names, labels and fine labels are unique. Error kConfig.
Status CheckClasses(const AssembleOptions& options);

/// Sets the dataset's classes and fine labels, in the order of `options.classes`, absent ones included, and each clip's
/// class by its label. Clips of no class are excluded with a finding. Without a list: see OrderedLabels, and fine
/// labels in the order of their classes, by name.
void ApplyClasses(const AssembleOptions& options, Dataset& dataset, std::vector<Finding>& findings);

/// "class_without_clips" for listed classes without a clip.
void FindEmptyClasses(const AssembleOptions& options, const Dataset& dataset, std::vector<Finding>& findings);

/// Findings for numbers of clips, frames, persons, or clips of a class that differ from `options.expected` and
/// `options.classes`.
void CompareWithExpected(const AssembleOptions& options, const Dataset& dataset, std::vector<Finding>& findings);

}  // namespace mocurate
