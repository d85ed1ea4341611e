#pragma once

#include <map>
#include <string>
#include <vector>

#include "canon/values/subset.h"

namespace mocurate {

/// A dataset whose motions were fitted again.
struct RefittedDataset {
  Dataset dataset;
  std::vector<std::size_t> rows;  ///< of the clips in the original dataset
  /// "clip_not_fitted" (error) for each failed clip, with the parts of splits that it leaves; "empty_part". Also in the
  /// dataset, beside the findings of the fits.
  std::vector<Finding> findings;
};

/// `before` with the motions, rates and segments of `fits`, whose clips have the ids of the original ones. Labels keep
/// their order and indices, as do fine labels; a label that `fits` renamed follows at the end. Rows of splits follow,
/// those of clips that were not fitted are removed. `failed`: reason by id. `how` is added to the recipe.
RefittedDataset RefitDataset(Dataset before, Dataset fits, const std::map<std::string, std::string>& failed,
                             const std::string& how);

}  // namespace mocurate
