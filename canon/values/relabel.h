#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "canon/values/where.h"
#include "core/base/options.h"
#include "core/store/store.h"

namespace mocurate {

/// A label for the clips that a condition selects.
struct RelabelRule {
  std::string where;
  std::string label;
  std::string place;  ///< "map.yaml:7:5", for messages

  void Declare(OptionVisitor& v);
};

/// New labels. The label of a clip comes from the table, else from the first matching rule, else from `labels`. All
/// refer to the dataset before the change.
struct RelabelMap {
  std::map<std::string, std::string> labels;  ///< old -> new, also of segments; several may become one
  std::vector<std::string> classes;           ///< in the order of their indices; empty: as the first old label of each
  std::vector<std::string> drop;              ///< old labels, whose clips and segments are removed
  std::vector<RelabelRule> rules;
  std::filesystem::path clips;               ///< CSV with the columns `clip` and `label`, or empty
  std::map<std::string, std::string> table;  ///< its content: clip -> label
  std::string name;                          ///< of the file, for messages and the recipe

  void Declare(OptionVisitor& v);
};

/// A YAML mapping of old to new labels, or of the fields of RelabelMap; the fields' names cannot be old labels then.
/// Errors kNotFound, kConfig with all errors.
Expected<RelabelMap> ReadRelabelMap(const std::filesystem::path& path);

/// A dataset with other labels.
struct RelabelledDataset {
  Dataset dataset;
  std::vector<std::size_t> rows;                                       ///< of the clips in the original dataset
  std::size_t segments = 0;                                            ///< number with another label
  std::map<std::pair<std::string, std::string>, std::size_t> changes;  ///< clips by old and new label
  /// "unknown_label", "unknown_clip": names of the map that the dataset lacks. "relabelled" and "dropped" (info) for
  /// each label that changed, "fine_label_cleared" (info) where it belonged to another class, "empty_part". Also in the
  /// dataset.
  std::vector<Finding> findings;
};

/// Clips, segments, classes and fine labels with their new labels. Without `classes`, a new label gets the index of its
/// first old label; new ones follow in the order of rules and table. Splits keep their parts. Motions are passed
/// through, with frames or without. Error kConfig: nothing in the map matches the dataset; a label that clips would
/// have is not in `classes`; a rule is not a condition. kInconsistent: no clip is left.
Expected<RelabelledDataset> Relabel(Dataset dataset, const RelabelMap& map);

}  // namespace mocurate
