#include <algorithm>
#include <map>
#include <system_error>

#include "core/base/config_parts.h"
#include "core/base/file.h"
#include "core/base/resources.h"
#include "core/base/text.h"

namespace mocurate {
namespace internal {
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

void Merge(ConfigNode& lower, ConfigNode upper) {
  if (lower.kind != ConfigNode::Kind::kMapping || upper.kind != ConfigNode::Kind::kMapping) {
    lower = std::move(upper);
    return;
  }
  std::map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < lower.mapping.size(); ++i) places.emplace(lower.mapping[i].first, i);
  for (auto& [key, value] : upper.mapping) {
    const auto found = places.find(key);
    if (found != places.end()) {
      Merge(lower.mapping[found->second].second, std::move(value));
    } else {
      lower.mapping.emplace_back(key, std::move(value));
    }
  }
  lower.origin = upper.origin;
  lower.key_origin = upper.key_origin;
  lower.base_folder = upper.base_folder;
}

/// Applies "a.b.0.c=YAML" to the tree.
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

}  // namespace internal

namespace {

namespace fs = std::filesystem;
using internal::Quoted;

constexpr std::string_view kResource = "resource:";
constexpr std::size_t kDeepestInclude = 32;
constexpr std::size_t kMostIncludes = 256;

bool IsResource(std::string_view name) { return name.substr(0, kResource.size()) == kResource; }

/// The embedded file `name`, which begins with "resource:".
std::optional<ConfigSource> ResourceSource(const std::string& name) {
  const fs::path path = fs::path(name.substr(kResource.size())).lexically_normal();
  const std::optional<std::string_view> text = FindResource(path.native());
  if (!text) return std::nullopt;
  return ConfigSource{std::string(*text), std::string(kResource) + path.native(), {}};
}

Expected<ConfigSource> FileSource(const fs::path& path, bool pipes) {
  Expected<std::string> text = ReadSmallFile(path, internal::kMostConfigBytes, pipes);
  if (!text) return Forward(text);
  return ConfigSource{std::move(*text), DisplayPath(path), path.parent_path()};
}

/// Whether a path is below a folder when its links and `..` are followed.
bool IsBelow(const fs::path& folder, const fs::path& path) {
  std::error_code error;
  // Absolute first: a relative path that does not exist would stay relative.
  const fs::path top = fs::weakly_canonical(fs::absolute(folder.empty() ? "." : folder, error), error);
  if (error) return false;
  const fs::path whole = fs::weakly_canonical(fs::absolute(path, error), error);
  return !error && std::mismatch(top.begin(), top.end(), whole.begin(), whole.end()).first == top.end();
}

/// Reads a source and what it includes, merged.
class Loader {
 public:
  /// Files are included from below `folder`, or with `anywhere` from everywhere.
  Loader(const fs::path& folder, bool anywhere, ProblemList& problems)
      : folder_(folder), anywhere_(anywhere), problems_(problems) {}

  ConfigNode Load(const ConfigSource& source) {
    open_.push_back(Identity(source));
    ConfigNode own = internal::ParseYaml(source, true, problems_);
    ConfigNode merged;
    merged.kind = ConfigNode::Kind::kMapping;
    for (const ConfigNode& include : TakeIncludes(own)) LoadInclude(source, include, merged);
    internal::Merge(merged, std::move(own));
    open_.pop_back();
    return merged;
  }

 private:
  /// Equal for two names of one file.
  static std::string Identity(const ConfigSource& source) {
    if (IsResource(source.name)) return source.name;
    std::error_code error;
    const fs::path path = source.base_folder / fs::path(source.name).filename();
    const fs::path canonical = fs::weakly_canonical(path, error);
    return error ? path.native() : canonical.native();
  }

  std::vector<ConfigNode> TakeIncludes(ConfigNode& root) {
    std::vector<ConfigNode> includes;
    for (std::size_t i = 0; i < root.mapping.size(); ++i) {
      if (root.mapping[i].first != "include") continue;
      ConfigNode value = std::move(root.mapping[i].second);
      root.mapping.erase(root.mapping.begin() + static_cast<std::ptrdiff_t>(i));
      if (value.kind == ConfigNode::Kind::kSequence) {
        includes = std::move(value.sequence);
      } else {
        includes.push_back(std::move(value));
      }
      break;
    }
    return includes;
  }

  void LoadInclude(const ConfigSource& from, const ConfigNode& include, ConfigNode& merged) {
    const std::string where = include.origin.Text();
    if (include.kind != ConfigNode::Kind::kScalar || include.scalar.empty()) {
      return problems_.Add(where, "include must be a path or a list of paths");
    }
    const std::string name = internal::ResolveEnvironment(include, problems_);
    if (name.empty()) return;
    if (open_.size() > kDeepestInclude || ++count_ > kMostIncludes || bytes_ > internal::kMostConfigBytes) {
      return problems_.Add(
          where, "too many includes",
          "at most " + std::to_string(kDeepestInclude) + " deep and " + std::to_string(kMostIncludes) + " in all");
    }
    const Expected<ConfigSource> source = FindSource(from, name);
    if (!source) {
      return problems_.Add(
          where, "cannot include " + Quoted(name) + ": " + source.error().what + " (" + source.error().where + ")",
          source.error().hint);
    }
    const std::string identity = Identity(*source);
    if (std::find(open_.begin(), open_.end(), identity) != open_.end()) {
      return problems_.Add(where, Quoted(name) + " includes itself" + ChainTo(identity));
    }
    bytes_ += source->text.size();
    if (bytes_ > internal::kMostConfigBytes) {
      return problems_.Add(where, "the included files are together larger than " +
                                      std::to_string(internal::kMostConfigBytes >> 20) + " MiB");
    }
    internal::Merge(merged, Load(*source));
  }

  std::string ChainTo(const std::string& identity) const {
    if (open_.back() == identity) return {};
    std::string chain = ", by way of ";
    for (auto it = std::find(open_.begin(), open_.end(), identity) + 1; it != open_.end(); ++it) {
      chain += Quoted(fs::path(*it).filename().native()) + (it + 1 != open_.end() ? ", " : "");
    }
    return chain;
  }

  Expected<ConfigSource> IncludedFile(const fs::path& path) const {
    if (!anywhere_ && !IsBelow(folder_, path)) {
      std::error_code unknown;
      return Fail(ErrorCode::kConfig,
                  "its place " + internal::Quoted(DisplayPath(fs::weakly_canonical(path, unknown))) +
                      " is not below the folder of the configuration",
                  DisplayPath(path), "copy the file there, or allow it with --allow-include");
    }
    return FileSource(path, false);
  }

  /// A file beside `from` before an embedded file of that name; inside embedded files the other way round.
  Expected<ConfigSource> FindSource(const ConfigSource& from, const std::string& name) const {
    const fs::path path = (from.base_folder / PathFromText(name)).lexically_normal();
    std::error_code error;
    if (!IsResource(from.name) && fs::exists(path, error)) return IncludedFile(path);
    const std::string plain = IsResource(name) ? name.substr(kResource.size()) : name;
    if (IsResource(from.name) && !IsResource(name)) {
      const fs::path beside = fs::path(from.name.substr(kResource.size())).parent_path() / plain;
      if (std::optional<ConfigSource> source = ResourceSource(std::string(kResource) + beside.native())) {
        return std::move(*source);
      }
    }
    if (std::optional<ConfigSource> source = ResourceSource(std::string(kResource) + plain)) return std::move(*source);
    if (IsResource(name)) {
      return Fail(ErrorCode::kNotFound, "the embedded file does not exist", name, HintFor(plain, ResourcePaths()));
    }
    return IncludedFile(path);
  }

  fs::path folder_;
  bool anywhere_;
  ProblemList& problems_;
  std::vector<std::string> open_;
  std::size_t count_ = 0;
  std::size_t bytes_ = 0;  ///< of all included files
};

/// Merges the profile that `profile` names of the mapping `profiles` into the tree, which then has no `profiles`.
void ApplyProfile(ConfigNode& root, ProblemList& problems) {
  const auto at = std::find_if(root.mapping.begin(), root.mapping.end(),
                               [](const auto& entry) { return entry.first == "profiles"; });
  if (at == root.mapping.end()) return;
  ConfigNode profiles = std::move(at->second);
  root.mapping.erase(at);
  const ConfigNode* chosen = root.Find("profile");
  if (chosen == nullptr || chosen->scalar.empty()) return;
  std::vector<std::string> names;
  for (auto& [name, profile] : profiles.mapping) {
    if (name == chosen->scalar) return internal::Merge(root, std::move(profile));
    names.push_back(name);
  }
  problems.Add(chosen->origin.Text(), "there is no profile " + internal::Quoted(chosen->scalar),
               DidYouMean(chosen->scalar, names, "there are: " + JoinTexts(names)));
}

}  // namespace

Expected<ConfigNode> LoadConfig(const ConfigSource& source, const std::vector<std::string>& assignments,
                                const ConfigRules& rules) {
  ProblemList problems;
  ConfigNode root = Loader(source.base_folder, rules.allow_include, problems).Load(source);
  for (const std::string& assignment : assignments) internal::Assign(root, assignment, problems);
  if (root.Find("profiles") != nullptr) {  // the command line overrides a profile
    ApplyProfile(root, problems);
    ProblemList repeated;  // the first pass reported them
    for (const std::string& assignment : assignments) internal::Assign(root, assignment, repeated);
  } else {
    for (const std::string& assignment : assignments) {
      if (assignment.rfind("profile=", 0) != 0) continue;
      problems.Add(assignment, "the config has no `profiles`", "remove the profile, or choose a config that has it");
    }
  }
  if (Status read = problems.Result(); !read) return Forward(read);
  internal::ResolveReferences(root, rules.unset, problems);
  if (Status resolved = problems.Result(); !resolved) return Forward(resolved);
  return root;
}

Expected<ConfigNode> LoadConfig(const fs::path& file, const std::vector<std::string>& assignments,
                                const ConfigRules& rules) {
  std::error_code error;
  if (IsResource(file.native()) && !fs::exists(file, error)) {
    if (const std::optional<ConfigSource> source = ResourceSource(file.native())) {
      return LoadConfig(*source, assignments, rules);
    }
    return Fail(ErrorCode::kNotFound, "the embedded file does not exist", DisplayPath(file),
                HintFor(file.native().substr(kResource.size()), ResourcePaths()));
  }
  const Expected<ConfigSource> source = ReadConfigFile(file);
  if (!source) return Forward(source);
  return LoadConfig(*source, assignments, rules);
}

Expected<ConfigSource> ReadConfigFile(const fs::path& file) { return FileSource(file, true); }

Expected<ConfigNode> LoadData(const ConfigSource& source) {
  ProblemList problems;
  ConfigNode root = internal::ParseYaml(source, true, problems);
  if (Status read = problems.Result(); !read) return Forward(read);
  internal::KeepReferences(root);
  return root;
}

Expected<ConfigNode> LoadData(const fs::path& file) {
  const Expected<ConfigSource> source = FileSource(file, false);
  if (!source) return Forward(source);
  return LoadData(*source);
}

}  // namespace mocurate
