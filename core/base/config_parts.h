#pragma once

#include <string>
#include <string_view>

#include "core/base/config.h"
#include "core/base/problem_list.h"

/// The steps of LoadConfig, each adding its errors to a list of problems.
namespace mocurate::internal {

/// Bounds that a configuration written by hand never meets; they stop hostile input early.
constexpr std::size_t kMostConfigBytes = std::size_t{16} << 20;
constexpr std::size_t kMostConfigNodes = 100000;
constexpr std::size_t kMostConfigDepth = 64;

/// Text of one YAML document. An empty document is an empty mapping when `need_mapping`, else null.
ConfigNode ParseYaml(const ConfigSource& source, bool need_mapping, ProblemList& problems);

/// Mappings are merged key by key; anything else of `upper` takes the place of `lower`.
void Merge(ConfigNode& lower, ConfigNode upper);

/// Replaces `${...}` in every scalar.
void ResolveReferences(ConfigNode& root, UnsetVariables unset, ProblemList& problems);

/// Replaces `$${` by `${` in every scalar, and nothing else.
void KeepReferences(ConfigNode& root);

/// Replaces `${NAME}` by the environment alone, for `include:`.
std::string ResolveEnvironment(const ConfigNode& scalar, ProblemList& problems);

/// The number of values in a tree, itself included.
std::size_t CountOf(const ConfigNode& node);
/// The bytes of their texts and keys.
std::size_t TextBytesOf(const ConfigNode& node);

/// Text in quotes for a message: cut when long, control characters escaped.
std::string Quoted(std::string_view text);

}  // namespace mocurate::internal
