#pragma once

#include <optional>
#include <string>
#include <vector>

namespace mocurate {

// Of a name: ASCII.
inline bool IsDigit(char c) { return c >= '0' && c <= '9'; }
inline bool IsLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
inline bool IsAlnum(char c) { return IsDigit(c) || IsLetter(c); }

/// "a/b" of "a/b/c.bvh"; empty of a name without a folder.
std::string FolderOf(const std::string& name);

/// A pattern that all of some names follow, guessed from what they have in common.
struct NamePatternEstimate {
  std::string pattern;              ///< as ingest.source.files; of one field {clip} where the names have no common form
  std::vector<std::string> fields;  ///< in order
  bool common = false;              ///< the names have a form in common

  bool Has(const std::string& field) const;
};

/// What names of one form share: folders, the places of '_', the ending.
std::string FormOf(const std::string& name);

/// Names are cut at '/' and '_'. A part that is the same in all stays; letters that are the same before differing
/// digits say what these are ("a01": {action}, "s3", "p07": {person}, "e2": {repetition}); the first part of differing
/// words is {action}, the second {style}, {clip} where each name has its own; digits alone at the end are {repetition}.
NamePatternEstimate EstimateNamePattern(const std::vector<std::string>& names);

/// For files that belong to others ("HDM_bd.asf" to "01/HDM_bd_jog_001.amc"): a text of the pattern's fields that gives
/// each of `belonging` from the name at the same place of `names`; empty ones are not asked. Nothing where there is
/// none.
std::optional<std::string> EstimateCompanionPattern(const NamePatternEstimate& guessed,
                                                    const std::vector<std::string>& names,
                                                    const std::vector<std::string>& belonging);

}  // namespace mocurate
