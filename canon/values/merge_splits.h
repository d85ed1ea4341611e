#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "canon/values/merge.h"

namespace mocurate {

/// Row of each clip in the merged dataset: by part, then by row there.
using MergedRows = std::vector<std::vector<int>>;

/// The splits of all parts, united by name. `merged` has its clips and their origins.
Expected<std::vector<Split>> MergeSplits(const std::vector<MergePart>& parts, const MergedRows& new_rows,
                                         const MergedDataset& merged, std::vector<Finding>& findings);

}  // namespace mocurate
