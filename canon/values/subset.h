#pragma once

#include <string>
#include <vector>

#include "canon/values/where.h"
#include "core/store/store.h"

namespace mocurate {

struct SubsetOptions {
  std::string name;                ///< of the original dataset, for the recipe
  bool drop_empty_labels = false;  ///< classes without a clip are removed, and the others renumbered
};

/// Some clips of a dataset.
struct DatasetSubset {
  Dataset dataset;
  std::vector<std::size_t> rows;  ///< of the clips in the original dataset
  std::vector<Finding> findings;  ///< "empty_part": a part of a split without a clip; also in the dataset
};

/// The clips that match a condition. Splits keep their parts, labels their order; motions are passed through, with
/// frames or without. Errors of Condition::Holds; kInconsistent where no clip is left, with the number of clips that
/// each test matches.
Expected<DatasetSubset> SubsetOf(Dataset dataset, const Condition& condition, const SubsetOptions& options);

}  // namespace mocurate
