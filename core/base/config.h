#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/base/options.h"

namespace mocurate {

/// Where a value was set: "kard.yaml:12:7", "--set", "default".
struct Origin {
  std::string file;  ///< a file, "--set", or "default"
  int line = 0;      ///< 1-based; 0 when the file has no lines
  int column = 0;
  std::string Text() const;
};

/// A YAML value with the origin of every part. Mappings keep the order of the file.
struct ConfigNode {
  enum class Kind { kNull, kScalar, kSequence, kMapping };
  Kind kind = Kind::kNull;
  std::string scalar;   ///< text as written, references resolved
  bool quoted = false;  ///< written in quotes: is text, never a number or a truth value
  bool unset = false;   ///< the text still has a reference, to an environment variable that is not set
  std::vector<ConfigNode> sequence;
  std::vector<std::pair<std::string, ConfigNode>> mapping;
  Origin origin;
  Origin key_origin;                  ///< of the key that names this value in its mapping
  std::filesystem::path base_folder;  ///< folder that relative paths inside refer to

  const ConfigNode* Find(const std::string& key) const;
};

struct ConfigSource {
  std::string text;
  std::string name;                   ///< shown in messages; normally the path
  std::filesystem::path base_folder;  ///< for `include:` and relative paths
};

/// What becomes of a reference to an environment variable that is not set.
enum class UnsetVariables { kRefuse, kKeep };

struct ConfigRules {
  bool allow_include = false;  ///< of files that are not below the folder of the outermost one
  UnsetVariables unset = UnsetVariables::kRefuse;
};

/// Parses YAML, refuses duplicate keys, merges `include:` (a path or a list; later and inner values win), applies
/// `assignments` ("ingest.path=DIR", values are YAML) and the profile that `profile` names of `profiles`, then resolves
/// `${ENV}` and `${other.key}`. All problems found are reported in one error, one per line, each "file:line:column:
/// ...". "resource:NAME" is the embedded file NAME, as `file` and in `include:`. An empty file is an empty mapping. The
/// rules are in docs/configuration.md. With UnsetVariables::kKeep a text keeps `${NAME}` where NAME is not set.
Expected<ConfigNode> LoadConfig(const std::filesystem::path& file, const std::vector<std::string>& assignments = {},
                                const ConfigRules& rules = {});
Expected<ConfigNode> LoadConfig(const ConfigSource& source, const std::vector<std::string>& assignments = {},
                                const ConfigRules& rules = {});

/// Text of a configuration's file. Errors of ReadSmallFile beyond 16 MiB; a pipe is read.
Expected<ConfigSource> ReadConfigFile(const std::filesystem::path& file);

/// Reads YAML that people exchange: decisions, maps, lists, skeletons, rigs, scripts. Nothing but its text counts:
/// `include` is a key as any other, and `${NAME}` is plain text (`$${` is `${` here too). `file` is a regular file of
/// at most 16 MiB.
Expected<ConfigNode> LoadData(const std::filesystem::path& file);
Expected<ConfigNode> LoadData(const ConfigSource& source);

namespace internal {
Status FromConfig(Declaration declaration, const ConfigNode& node);
nlohmann::json SchemaOf(Declaration declaration);
std::string ReferenceOf(Declaration declaration, const std::string& title);
std::string ShowOf(Declaration declaration, const ConfigNode& node, bool origins);
}  // namespace internal

/// Strict reading into declared options; all problems at once (unknown keys with "did you mean", wrong types, values
/// out of range, missing or wrong units).
template <class Options>
Expected<Options> OptionsFromConfig(const ConfigNode& node) {
  Options options;
  if (Status read = internal::FromConfig(internal::DeclarationOf(options), node); !read) {
    return tl::unexpected<Error>(read.error());
  }
  return options;
}

/// JSON Schema (draft 2020-12) of declared options, for editors: nlohmann::json, which the caller includes.
template <class Options>
auto OptionsSchema() {
  Options options;
  return internal::SchemaOf(internal::DeclarationOf(options));
}

/// Markdown reference: name, type, unit, default, range, help.
template <class Options>
std::string OptionsReference(const std::string& title) {
  Options options;
  return internal::ReferenceOf(internal::DeclarationOf(options), title);
}

/// Resolved options as YAML text; with `origins`, each line ends with a comment that names the origin of its value.
template <class Options>
std::string ShowOptions(const Options& options, const ConfigNode& node, bool origins) {
  Options copy = options;
  return internal::ShowOf(internal::DeclarationOf(copy), node, origins);
}

}  // namespace mocurate
