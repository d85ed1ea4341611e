#pragma once

#include <string>
#include <vector>

#include "canon/values/where.h"
#include "core/store/store.h"

namespace mocurate {

struct SubsetOptions {
  std::string name;                ///< of the dataset that the clips are from, for the recipe
  bool drop_empty_labels = false;  ///< classes without a clip leave, and the others close up
};

/// Some clips of a dataset.
struct DatasetSubset {
  Dataset dataset;
  std::vector<std::size_t> rows;  ///< of the clips in the dataset that they are from
  std::vector<Finding> findings;  ///< "empty_part": a part of a split that has no clip any more; also in the dataset
};

/// The clips that a condition holds for. Splits keep their parts, labels their order; motions are handed on as they
/// are, with frames or without. Errors of Condition::Holds; kInconsistent where no clip is left, with the clips that
/// each test holds for.
Expected<DatasetSubset> SubsetOf(Dataset dataset, const Condition& condition, const SubsetOptions& options);

}  // namespace mocurate
