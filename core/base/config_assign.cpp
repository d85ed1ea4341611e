#include <algorithm>

#include "core/base/config_parts.h"
#include "core/base/text.h"

namespace mocurate::internal {
namespace {

constexpr const char* kSet = "--set";

void MarkAsSet(ConfigNode& node) {
  node.origin = {kSet, 0, 0};
  node.key_origin = node.origin;
  node.base_folder.clear();  // the current folder
  for (ConfigNode& child : node.sequence) MarkAsSet(child);
  for (auto& entry : node.mapping) MarkAsSet(entry.second);
}

ConfigNode* IntoSequence(ConfigNode& node, const std::string& key, const std::string& so_far, ProblemList& problems) {
  const std::optional<long long> index = ParseInteger(key);
  if (!index || *index < 0 || static_cast<std::size_t>(*index) >= node.sequence.size()) {
    problems.Add(kSet,
                 Quoted(so_far) + " is a list of " + std::to_string(node.sequence.size()) + ", " + Quoted(key) +
                     " is not one of its positions",
                 node.sequence.empty() ? "" : "positions: 0 to " + std::to_string(node.sequence.size() - 1));
    return nullptr;
  }
  return &node.sequence[static_cast<std::size_t>(*index)];
}

ConfigNode* IntoMapping(ConfigNode& node, const std::string& key) {
  for (auto& [name, value] : node.mapping) {
    if (name == key) return &value;
  }
  ConfigNode fresh;
  MarkAsSet(fresh);
  node.mapping.emplace_back(key, std::move(fresh));
  return &node.mapping.back().second;
}

/// The node that `path` names, made where it does not exist; null after a problem.
ConfigNode* NodeAt(ConfigNode& root, const std::string& path, ProblemList& problems) {
  ConfigNode* node = &root;
  std::string so_far;
  for (const std::string_view part : SplitText(path, '.')) {
    const std::string key(part);
    if (node->kind == ConfigNode::Kind::kSequence) {
      node = IntoSequence(*node, key, so_far, problems);
      if (node == nullptr) return nullptr;
    } else if (node->kind == ConfigNode::Kind::kScalar) {
      problems.Add(kSet, Quoted(so_far) + " is a single value, it has no " + Quoted(key));
      return nullptr;
    } else {
      node->kind = ConfigNode::Kind::kMapping;
      node = IntoMapping(*node, key);
    }
    so_far += (so_far.empty() ? "" : ".") + key;
  }
  return node;
}

}  // namespace

void Assign(ConfigNode& root, const std::string& assignment, ProblemList& problems) {
  const std::size_t equals = assignment.find('=');
  const std::string path(Trim(std::string_view(assignment).substr(0, equals)));
  const std::vector<std::string_view> parts = SplitText(path, '.');
  const bool has_empty_part = std::any_of(parts.begin(), parts.end(), [](std::string_view p) { return p.empty(); });
  if (equals == std::string::npos || has_empty_part || parts.size() > kMostConfigDepth) {
    return problems.Add(kSet, Quoted(assignment) + " must be KEY=VALUE", "e.g. --set canon.trim.margin='40 ms'");
  }
  ConfigSource source;
  source.text = assignment.substr(equals + 1);
  source.name = "--set " + path;
  ConfigNode value = ParseYaml(source, false, problems);
  MarkAsSet(value);
  if (ConfigNode* node = NodeAt(root, path, problems)) Merge(*node, std::move(value));
}

}  // namespace mocurate::internal
