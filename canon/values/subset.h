#pragma once

#include <string>
#include <vector>

#include "canon/values/where.h"
#include "core/store/store.h"

namespace mocurate {

/// Whether a finding concerns a clip: it names the clip, or the recording that the clip was cut from, in frames that
/// the clip has or without frames.
bool IsAbout(const Finding& finding, const Clip& clip);

/// Keeps some clips of a dataset: rows of splits follow, findings about removed clips are removed. Labels stay, also
/// those without a clip. Returns the old indices of the rows that stay.
std::vector<std::size_t> KeepRows(const std::vector<bool>& keep, Dataset& dataset);

/// Appends the findings that are not in `all` yet.
void AddFindings(const std::vector<Finding>& more, std::vector<Finding>& all);

/// "empty_part" for each part that lost its last clip; the same splits before and after.
std::vector<Finding> FindEmptyParts(const std::vector<Split>& before, const std::vector<Split>& after);

/// Adds "(before CHANGE)" to the leak checks that found leaks, as in "(before clips were chosen)".
void NoteEarlierChecks(const std::string& change, Dataset& dataset);

void AddToRecipe(const std::string& line, Dataset& dataset);

/// Removes labels and fine labels without a clip; the others are renumbered.
void DropEmptyLabels(Dataset& dataset);

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
