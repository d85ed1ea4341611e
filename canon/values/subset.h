#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "canon/values/where.h"
#include "core/store/store.h"

namespace mocurate {

/// First frame of a clip, of its id "source/person/recording#begin-end"; nothing where the id has no frames.
std::optional<int> FirstFrameOfId(const std::string& id);

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

/// A dataset made of another one.
struct ChangedDataset {
  Dataset dataset;
  std::vector<std::size_t> rows;  ///< of the clips in the original dataset
  std::vector<Finding> findings;  ///< also in the dataset
};

/// The clips that match a condition, and with `drop_empty_labels` only classes that have a clip. `name`: of the
/// original dataset, for the recipe. Splits keep their parts, labels their order; motions are passed through, with
/// frames or without. Errors of Condition::Holds; kInconsistent where no clip is left, with the number of clips that
/// each test matches. Finding "empty_part": a part of a split without a clip.
Expected<ChangedDataset> SubsetOf(Dataset dataset, const Condition& condition, const std::string& name,
                                  bool drop_empty_labels = false);

/// `before` with the motions, rates and segments of `fits`, whose clips have the ids of the original ones. Labels keep
/// their order and indices, as do fine labels; a label that `fits` renamed follows at the end. Rows of splits follow,
/// those of clips that were not fitted are removed. `failed`: reason by id. `how` is added to the recipe.
/// Findings: "clip_not_fitted" (error) for each failed clip, with the parts of splits that it leaves; "empty_part". In
/// the dataset they are beside those of the fits.
ChangedDataset RefitDataset(Dataset before, Dataset fits, const std::map<std::string, std::string>& failed,
                            const std::string& how);

}  // namespace mocurate
