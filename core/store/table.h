#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/store/array.h"

namespace mocurate::store {

/// What a rule may look at: its own field and, by path, the others (their types and shapes have been checked).
struct RuleContext {
  const Array& array;
  const Content& content;
  std::string path;
  std::string prefix;  ///< "" or "/truth": prefix of /frames, /clips, ...
  /// Another field of the same group.
  const Array* Sibling(const std::string& name) const;
};

/// A rule as text, and its check, which returns the violation or nothing.
struct Rule {
  std::string words;
  std::function<std::optional<std::string>(const RuleContext&)> check;
};

/// When a field has to be there.
enum class Presence {
  kAlways,
  kOptional,
  kGroup,   ///< whenever another field of Field::group is
  kMotion,  ///< when /@kinematics is not "none", and only then
  kTree,    ///< when /@kinematics is "tree", and only then
};

/// One line of the table: everything there is to know about a field.
struct Field {
  std::string path;  ///< * is the name of a split
  FieldType type;
  std::vector<std::string> shape;  ///< symbols ("F") and fixed extents ("3"); empty for a scalar
  std::string unit;
  Presence presence;
  Rule rule;
  std::string meaning;
  std::string group;  ///< for kGroup
};

/// One kind of file.
struct Schema {
  std::string name;     ///< "mocurate/1"
  std::string purpose;  ///< one sentence
  std::string prefix;   ///< "" or "/truth"
  std::vector<Field> fields;
  std::string verb;  ///< that makes such a file

  /// Way out for a file of another version: no verb converts it.
  std::string MakeAgain() const { return "a file of another version is made again by `mocurate " + verb + "`"; }
};

const Schema& DatasetSchema();
const Schema& EvidenceSchema();
const Schema& TruthSchema();
const Schema& FeatureSchema();
std::vector<const Schema*> AllSchemas();
/// Whether two names are of one schema in two versions: "mocurate/1", "mocurate/2".
bool AreVersions(const std::string& a, const std::string& b);

/// The table with * replaced by every split of `content`.
std::vector<Field> ConcreteFields(const Schema& schema, const Content& content);

/// Checks presence, type and shape of every field. `where` makes the place of a field from its path; `code` is the code
/// of the error, kMalformed for a content that was read.
Status CheckFields(const Schema& schema, const Content& content, ErrorCode code,
                   const std::function<std::string(const std::string& path)>& where);

/// CheckFields, and the rule of every field but of those in Content::later.
Status CheckContent(const Schema& schema, const Content& content, ErrorCode code,
                    const std::function<std::string(const std::string& path)>& where);

/// Checks the rules of the fields below `group` alone ("/frames/"), of a content that holds what they look at.
Status CheckRulesBelow(const std::string& group, const Schema& schema, const Content& content, ErrorCode code,
                       const std::function<std::string(const std::string& path)>& where);

}  // namespace mocurate::store
