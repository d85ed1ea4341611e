#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>

#include "core/base/config_parts.h"
#include "core/base/text.h"

namespace mocurate::internal {
namespace {

constexpr std::size_t kDeepestReference = 500;
constexpr std::size_t kMostResolvedBytes = std::size_t{16} << 20;
constexpr std::size_t kMostNear = 1000;

/// A piece of a scalar: literal text, or the name inside `${...}`.
struct Piece {
  bool is_reference = false;
  std::string text;
};

/// Takes "a${b}c" apart; `$${` is the literal "${".
std::vector<Piece> PiecesOf(const ConfigNode& node, ProblemList& problems) {
  std::vector<Piece> pieces;
  std::string literal;
  std::string_view rest = node.scalar;
  while (!rest.empty()) {
    if (rest.substr(0, 3) == "$${") {
      literal += "${";
      rest.remove_prefix(3);
    } else if (rest.substr(0, 2) == "${") {
      const std::size_t end = rest.find('}');
      if (end == std::string_view::npos) {
        problems.Add(node.origin.Text(), "'${' without '}' in " + Quoted(node.scalar), "write $${ for a literal ${");
        return {{false, node.scalar}};
      }
      if (!literal.empty()) pieces.push_back({false, std::move(literal)});
      literal.clear();
      pieces.push_back({true, std::string(Trim(rest.substr(2, end - 2)))});
      rest.remove_prefix(end + 1);
    } else {
      literal += rest.front();
      rest.remove_prefix(1);
    }
  }
  if (!literal.empty()) pieces.push_back({false, std::move(literal)});
  return pieces;
}

bool HasReference(const ConfigNode& node) {
  return node.kind == ConfigNode::Kind::kScalar && node.scalar.find("${") != std::string::npos;
}

/// Whether a name is written like an environment variable's.
bool IsVariable(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

std::string HowToSet(const std::string& name) {
  if (IsVariable(name)) return "export " + name + "=..., or give the value with --set";
  return "write $${ for a literal ${";
}

/// The first keys of a tree, for Nearest.
void CollectKeys(const ConfigNode& node, const std::string& prefix, std::vector<std::string>& keys) {
  for (const auto& [key, value] : node.mapping) {
    if (keys.size() >= kMostNear) return;
    keys.push_back(prefix + key);
    CollectKeys(value, keys.back() + ".", keys);
  }
}

class Resolver {
 public:
  Resolver(ConfigNode& root, UnsetVariables unset, ProblemList& problems)
      : root_(root), unset_(unset), problems_(problems) {}

  void Resolve(ConfigNode& node) {
    if (overspent_ || done_.count(&node) != 0) return;
    if (open_.size() >= kDeepestReference) {
      return problems_.Add(node.origin.Text(),
                           "more than " + std::to_string(kDeepestReference) + " references lead from one to the next");
    }
    open_.push_back(&node);
    for (ConfigNode& child : node.sequence) Resolve(child);
    for (auto& entry : node.mapping) Resolve(entry.second);
    if (HasReference(node)) ResolveScalar(node);
    open_.pop_back();
    done_.insert(&node);
  }

 private:
  void ResolveScalar(ConfigNode& node) {
    const std::vector<Piece> pieces = PiecesOf(node, problems_);
    if (pieces.size() == 1 && pieces[0].is_reference) return TakeWhole(node, pieces[0].text);
    std::string text;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (!pieces[i].is_reference) {
        text += pieces[i].text;
        continue;
      }
      ConfigNode value;
      if (!Value(node, pieces[i].text, value)) return;
      if (value.kind != ConfigNode::Kind::kScalar) {
        return problems_.Add(node.origin.Text(), "${" + pieces[i].text + "} inside a text must name a single value");
      }
      if (i == 0) node.base_folder = value.base_folder;
      node.unset = node.unset || value.unset;
      text += value.scalar;
      if (!Spend(node, value.scalar.size())) return;
    }
    node.scalar = std::move(text);
  }

  /// A value that is nothing but a reference becomes what it names, of any kind.
  void TakeWhole(ConfigNode& node, const std::string& name) {
    ConfigNode value;
    if (!Value(node, name, value)) return;
    if (node.quoted && value.kind != ConfigNode::Kind::kScalar) {
      return problems_.Add(node.origin.Text(), "${" + name + "} in quotes must name a single value");
    }
    node.kind = value.kind;
    node.scalar = std::move(value.scalar);
    node.quoted = node.quoted || value.quoted;
    node.unset = value.unset;
    node.sequence = std::move(value.sequence);
    node.mapping = std::move(value.mapping);
    node.base_folder = std::move(value.base_folder);
    MarkDone(node);
  }

  /// A copy of the value of `name`; false after a problem.
  bool Value(const ConfigNode& node, const std::string& name, ConfigNode& value) {
    ConfigNode* target = nullptr;
    if (!FindTarget(node, name, target)) return false;
    if (target != nullptr) {
      Resolve(*target);
      if (!Spend(node, 64 * CountOf(*target) + TextBytesOf(*target))) return false;
      value = *target;
      return true;
    }
    const char* variable = name.find('.') == std::string::npos ? std::getenv(name.c_str()) : nullptr;
    if (variable == nullptr && unset_ == UnsetVariables::kKeep && IsVariable(name)) {
      value.kind = ConfigNode::Kind::kScalar;
      value.scalar = "${" + name + "}";
      value.quoted = value.unset = true;
      return true;
    }
    if (variable == nullptr) {
      problems_.Add(node.origin.Text(),
                    "${" + name + "} names neither a key of this configuration nor an environment variable", [&] {
                      std::vector<std::string> keys;
                      CollectKeys(root_, "", keys);
                      return DidYouMean(name, keys, HowToSet(name));
                    });
      return false;
    }
    value.kind = ConfigNode::Kind::kScalar;
    value.scalar = variable;
    value.quoted = value.scalar.empty();
    return Spend(node, value.scalar.size());
  }

  /// Follows a key path from the root; null when it names no key. False for a reference to itself.
  bool FindTarget(const ConfigNode& from, const std::string& name, ConfigNode*& target) {
    ConfigNode* node = &root_;
    for (const std::string_view part : SplitText(name, '.')) {
      if (HasReference(*node) && done_.count(node) == 0) {
        if (!RefuseCycle(from, *node, name)) return false;
        Resolve(*node);
      }
      node = Child(*node, part);
      if (node == nullptr) return true;
    }
    if (!RefuseCycle(from, *node, name)) return false;
    target = node;
    return true;
  }

  bool RefuseCycle(const ConfigNode& from, const ConfigNode& node, const std::string& name) {
    if (std::find(open_.begin(), open_.end(), &node) == open_.end()) return true;
    problems_.Add(from.origin.Text(), "${" + name + "} leads back to itself",
                  &node == &from ? "" : "it starts at " + node.origin.Text());
    return false;
  }

  /// With an index of each mapping: many references name keys of one. A mapping that was looked up keeps
  /// its entries.
  ConfigNode* Child(ConfigNode& node, std::string_view key) {
    auto& places = places_[&node];
    if (places.empty()) {
      for (auto& entry : node.mapping) places.emplace(entry.first, &entry.second);
    }
    if (const auto found = places.find(key); found != places.end()) return found->second;
    const std::optional<long long> index = ParseInteger(key);
    if (!index || *index < 0 || static_cast<std::size_t>(*index) >= node.sequence.size()) return nullptr;
    return &node.sequence[static_cast<std::size_t>(*index)];
  }

  bool Spend(const ConfigNode& node, std::size_t bytes) {
    spent_ += bytes;
    if (spent_ <= kMostResolvedBytes) return true;
    if (!overspent_) problems_.Add(node.origin.Text(), "references written out take more than 16 MiB");
    overspent_ = true;
    return false;
  }

  void MarkDone(const ConfigNode& node) {
    done_.insert(&node);
    for (const ConfigNode& child : node.sequence) MarkDone(child);
    for (const auto& entry : node.mapping) MarkDone(entry.second);
  }

  ConfigNode& root_;
  UnsetVariables unset_;
  ProblemList& problems_;
  std::set<const ConfigNode*> done_;
  std::map<const ConfigNode*, std::map<std::string_view, ConfigNode*>> places_;  ///< of keys, by mapping
  std::vector<const ConfigNode*> open_;
  std::size_t spent_ = 0;
  bool overspent_ = false;
};

}  // namespace

void ResolveReferences(ConfigNode& root, UnsetVariables unset, ProblemList& problems) {
  Resolver(root, unset, problems).Resolve(root);
}

void KeepReferences(ConfigNode& root) {
  for (std::size_t at = 0; (at = root.scalar.find("$${", at)) != std::string::npos; at += 2) root.scalar.erase(at, 1);
  for (ConfigNode& child : root.sequence) KeepReferences(child);
  for (auto& entry : root.mapping) KeepReferences(entry.second);
}

std::string ResolveEnvironment(const ConfigNode& scalar, ProblemList& problems) {
  std::string text;
  for (const Piece& piece : PiecesOf(scalar, problems)) {
    const char* value = piece.is_reference ? std::getenv(piece.text.c_str()) : piece.text.c_str();
    if (value == nullptr) {
      problems.Add(scalar.origin.Text(),
                   "${" + piece.text + "} names no environment variable (include: cannot use keys)",
                   HowToSet(piece.text));
      return {};
    }
    text += value;
  }
  return text;
}

}  // namespace mocurate::internal
