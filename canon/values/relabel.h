#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "canon/values/where.h"
#include "core/base/options.h"
#include "core/store/store.h"

namespace mocurate {

/// A label for the clips that a condition holds for.
struct RelabelRule {
  std::string where;
  std::string label;
  std::string place;  ///< "map.yaml:7:5", for messages

  void Declare(OptionVisitor& v);
};

/// What labels become. The label of a clip is that of the table, else that of the first rule that holds for it, else
/// what `labels` makes of its own. All look at the dataset as it was.
struct RelabelMap {
  std::map<std::string, std::string> labels;  ///< old -> new, also of segments; several may become one
  std::vector<std::string> classes;           ///< in the order of their indices; empty: as the first old label of each
  std::vector<std::string> drop;              ///< labels as they were, whose clips and segments leave
  std::vector<RelabelRule> rules;
  std::filesystem::path clips;               ///< CSV with the columns `clip` and `label`, or empty
  std::map<std::string, std::string> table;  ///< what it holds: clip -> label
  std::string name;                          ///< of the file, for messages and the recipe

  void Declare(OptionVisitor& v);
};

/// A YAML mapping of old to new labels, or of the fields of RelabelMap; the fields' names are no old labels there.
/// Errors kNotFound, kConfig with all that is wrong.
Expected<RelabelMap> ReadRelabelMap(const std::filesystem::path& path);

/// A dataset with other labels.
struct RelabelledDataset {
  Dataset dataset;
  std::vector<std::size_t> rows;  ///< of the clips in the dataset that they are from
  std::size_t segments = 0;       ///< whose label is another
  std::map<std::pair<std::string, std::string>, std::size_t> changes;  ///< clips by old and new label
  /// "unknown_label", "unknown_clip": what the map names and the dataset has not. "relabelled" and "dropped" (info) for
  /// each label that changed, "fine_label_cleared" (info) where it is of another class now. Also in the dataset.
  std::vector<Finding> findings;
};

/// Clips, segments, classes and fine labels with their new labels. Without `classes` the class of a new label stands
/// where the first old label of it stood; new ones follow in the order of rules and table. Splits keep their parts.
/// Motions are handed on as they are, with frames or without. Error kConfig: nothing in the map fits the dataset; a
/// label that clips would have is not in `classes`; a rule is no condition. kInconsistent: no clip is left.
Expected<RelabelledDataset> Relabel(Dataset dataset, const RelabelMap& map);

}  // namespace mocurate
