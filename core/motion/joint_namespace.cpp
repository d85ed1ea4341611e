#include "core/motion/joint_namespace.h"

#include <algorithm>
#include <set>
#include <string_view>

namespace mocurate {
namespace {

constexpr std::size_t kFewestNames = 5;  // least names for a common prefix
constexpr std::string_view kSeparators = "_ .-";

bool IsCapital(char c) { return c >= 'A' && c <= 'Z'; }

/// What all but the first begin with.
std::string_view SharedBeginning(const std::vector<std::string>& names) {
  std::string_view shared = names[1];
  for (std::size_t j = 2; j < names.size(); ++j) {
    const auto differs = std::mismatch(shared.begin(), shared.end(), names[j].begin(), names[j].end()).first;
    shared = shared.substr(0, static_cast<std::size_t>(differs - shared.begin()));
  }
  return shared;
}

/// Length of the prefix that is not part of a joint's own name.
std::size_t NamespaceLength(const std::vector<std::string>& names, std::string_view shared) {
  for (std::size_t length = shared.size(); length > 0; --length) {
    if (kSeparators.find(shared[length - 1]) != std::string_view::npos) return length;
    const bool capitals = !IsCapital(shared[length - 1]) &&
                          std::all_of(names.begin() + 1, names.end(),
                                      [&](auto& name) { return name.size() > length && IsCapital(name[length]); });
    if (capitals) return length;
  }
  return 0;
}

}  // namespace

std::vector<std::string> WithoutNamespace(std::vector<std::string> names) {
  const std::vector<std::string> whole = names;
  for (std::string& name : names) {
    const std::size_t colon = name.find_last_of(":|");
    if (colon != std::string::npos && colon + 1 < name.size()) name.erase(0, colon + 1);
  }
  if (names.size() > kFewestNames) {
    const std::string shared(SharedBeginning(names));
    if (const std::size_t length = NamespaceLength(names, shared); length > 0) {
      for (std::string& name : names) {
        if (name.size() > length && name.compare(0, length, shared, 0, length) == 0) name.erase(0, length);
      }
    }
  }
  const auto distinct = [](const std::vector<std::string>& list) {
    return std::set<std::string>(list.begin(), list.end()).size();
  };
  return distinct(names) < distinct(whole) ? whole : names;
}

std::vector<std::string> NamesIn(const Skeleton& skeleton, const std::vector<std::string>& names) {
  const bool known = std::all_of(names.begin(), names.end(),
                                 [&](const std::string& name) { return skeleton.FindJoint(name).has_value(); });
  return known ? names : WithoutNamespace(names);
}

}  // namespace mocurate
