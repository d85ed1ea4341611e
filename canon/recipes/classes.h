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

/// Class names in the order of their indices: `order` as far as a clip has the label, then labels that `order` lacks,
/// by name. For sets without a list of classes (`assemble.classes`).
std::vector<std::string> OrderedLabels(const std::vector<std::string>& order, const std::set<std::string>& present);

/// Whether the list makes sense: names, labels and fine labels stand once. Error kConfig.
Status CheckClasses(const AssembleOptions& options);

/// Gives the dataset its classes and fine labels, in the order of `options.classes`, absent ones included, and each
/// clip the class that its label belongs to; clips of no class are excluded with a finding. Without a list: see
/// OrderedLabels, and fine labels in the order of their classes, by name.
void ApplyClasses(const AssembleOptions& options, Dataset& dataset, std::vector<Finding>& findings);

/// "class_without_clips" where listed classes have none.
std::vector<Finding> FindEmptyClasses(const AssembleOptions& options, const Dataset& dataset);

/// Where the set has another number of clips, frames or persons, or of clips of a class, than `options.expected` and
/// `options.classes` say.
std::vector<Finding> CompareWithExpected(const AssembleOptions& options, const Dataset& dataset);

}  // namespace mocurate
