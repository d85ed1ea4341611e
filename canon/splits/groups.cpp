#include "canon/splits/groups.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/random.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

bool Contains(const std::vector<std::string>& list, const std::string& value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

Finding SplitFinding(const SplitOptions& options, const char* code, std::string message, FindingAction action) {
  return MakeFinding(code, Severity::kWarning, 0.0, "split '" + options.name + "': " + std::move(message), action);
}

using Names = std::vector<std::string>;

std::string PlaceOf(const SplitOptions& options) { return "assemble.splits." + options.name; }

Error Impossible(const SplitOptions& options, std::string what, std::string hint) {
  return {ErrorCode::kConfig, std::move(what), PlaceOf(options), std::move(hint)};
}

/// "p1, p2", of many the first ones and their number.
std::string Shortened(const Names& names) {
  constexpr std::size_t kMost = 20;
  if (names.size() <= kMost) return JoinTexts(names);
  return JoinTexts({names.begin(), names.begin() + kMost}) + ", ... (" + std::to_string(names.size()) + ")";
}

/// "the set has: P01, P02"
std::string KnownNames(const std::set<std::string>& names) {
  Names known(names.begin(), names.end());
  known.erase(std::remove(known.begin(), known.end(), ""), known.end());
  return "the set has: " + (known.empty() ? "none" : Shortened(known));
}

/// Removes from `options` the names that no clip has, and returns them.
Names TakeAbsent(const std::set<std::string>& groups, SplitOptions& options) {
  Names absent;
  for (auto* names : {&options.test, &options.validation, &options.train}) {
    const auto gone = std::stable_partition(names->begin(), names->end(),
                                            [&](const std::string& name) { return groups.count(name) != 0; });
    absent.insert(absent.end(), gone, names->end());
    names->erase(gone, names->end());
  }
  return absent;
}

/// Groups that are named for no part, in a random order keyed by the group: other groups do not change it.
Names InOrderOfDraw(const SplitOptions& options, const std::set<std::string>& groups) {
  std::vector<std::pair<double, std::string>> order;
  for (const std::string& group : groups) {
    if (Contains(options.test, group) || Contains(options.validation, group) || Contains(options.train, group))
      continue;
    order.emplace_back(Random(static_cast<std::uint64_t>(options.seed), "split", group).Uniform(), group);
  }
  std::sort(order.begin(), order.end());
  Names names;
  names.reserve(order.size());
  for (auto& [draw, group] : order) names.push_back(std::move(group));
  return names;
}

/// Fills the empty part with a share of all groups, at least one, from the free ones; `left` of these stay.
void Draw(double share, std::size_t all, std::size_t left, Names& free, Names& part) {
  const auto wanted = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(share * static_cast<double>(all))));
  while (part.size() < wanted && free.size() > left) {
    part.push_back(free.front());
    free.erase(free.begin());
  }
  std::sort(part.begin(), part.end());
}

Error EmptyTrainingPart(const SplitOptions& options) {
  const std::string what = NameOf(options.by);
  return Impossible(options,
                    "every " + what + " of the set is named for test or validation, and none is left to train: " +
                        JoinTexts(options.test) + (options.validation.empty() ? "" : "; ") +
                        JoinTexts(options.validation),
                    "name fewer, or add clips of another " + what);
}

}  // namespace

bool NamesGroups(SplitBy by) { return by == SplitBy::kPerson || by == SplitBy::kStyle; }

const char* NameOf(SplitBy by) {
  switch (by) {
    case SplitBy::kPerson:
      return "person";
    case SplitBy::kStyle:
      return "style";
    case SplitBy::kFraction:
      return "performance";
    case SplitBy::kRole:
      return "role of the source";
  }
  return "";
}

Status CheckSplit(const SplitOptions& options) {
  std::map<std::string, const char*> part_of;
  const std::pair<const char*, const Names*> parts[] = {
      {"test", &options.test}, {"validation", &options.validation}, {"train", &options.train}};
  for (const auto& [part, names] : parts) {
    if (!NamesGroups(options.by) && !names->empty()) {
      const char* by = options.by == SplitBy::kRole ? "role" : "fraction";
      return tl::unexpected<Error>(Impossible(
          options,
          std::string("`") + part + "` names " + JoinTexts(*names) + ", but a split by " + by + " has no names",
          options.by == SplitBy::kRole ? "set by: person, or name them under ingest.source.roles"
                                       : "set by: person or by: style, or remove the names"));
    }
    for (const std::string& name : *names) {
      const char* other = part_of.emplace(name, part).first->second;
      if (other == part) continue;
      return tl::unexpected<Error>(Impossible(options,
                                              std::string("the ") + NameOf(options.by) + " '" + name +
                                                  "' is named under `" + other + "` and under `" + part + "`",
                                              "name it once"));
    }
  }
  return {};
}

Status CheckAbsent(const SplitOptions& options, const std::string& where, const std::vector<std::string>& absent,
                   const std::set<std::string>& there, std::vector<Finding>& findings) {
  if (absent.empty()) return {};
  std::set<std::string> nearest;
  const Names known(there.begin(), there.end());
  for (std::size_t i = 0; i < std::min<std::size_t>(absent.size(), 50); ++i) {
    if (const auto one = Nearest(absent[i], known)) nearest.insert(*one);
  }
  const std::string near =
      nearest.empty() ? "" : "did you mean '" + Shortened({nearest.begin(), nearest.end()}) + "'? ";
  const char* kind = options.by == SplitBy::kStyle ? "style" : "person";
  const std::string what = std::string("no clip has the ") + kind + " '" + Shortened(absent) + "'";
  if (options.absent == AbsentGroups::kRefuse) {
    return Fail(ErrorCode::kConfig, what, where,
                near + KnownNames(there) + "; or set absent: draw, for a set of other people");
  }
  findings.push_back(SplitFinding(options, "split_name_absent", what + " (" + near + KnownNames(there) + ")",
                                  FindingAction::kFlagged));
  return {};
}

Expected<ResolvedGroups> ResolveGroups(const SplitOptions& options, const std::set<std::string>& groups,
                                       std::vector<Finding>& findings) {
  if (Status once = CheckSplit(options); !once) return Forward(once);
  SplitOptions met = options;
  const Names absent = TakeAbsent(groups, met);
  if (Status all = CheckAbsent(options, PlaceOf(options), absent, groups, findings); !all) return Forward(all);
  const bool tests = options.test.empty() || !met.test.empty();
  const bool selects = options.validation.empty() || !met.validation.empty();
  const bool any_named = met.test.size() + met.validation.size() + met.train.size() > 0;
  Names free = InOrderOfDraw(met, groups);
  if (any_named && free.empty() && met.train.empty()) return tl::unexpected<Error>(EmptyTrainingPart(met));
  const bool drawn = !tests || !selects;
  const std::size_t trainers = met.train.empty() ? 1 : 0;  // of the free ones
  if (!tests) Draw(options.test_share, groups.size(), trainers, free, met.test);
  if (!selects) Draw(options.validation_share, groups.size(), trainers, free, met.validation);
  if (!tests && met.test.empty() && any_named) {
    return tl::unexpected<Error>(Impossible(options,
                                            std::string("the test part would be empty: none of '") +
                                                JoinTexts(options.test) +
                                                "' is in the set, and the others are named for train or validation",
                                            KnownNames(groups)));
  }
  if (!drawn) return ResolvedGroups{met, false};
  std::string message = "drawn instead:";
  if (!tests)
    message = met.test.empty()
                  ? "only one " + std::string(NameOf(options.by)) + ": it trains and the test part is empty"
                  : message + " " + JoinTexts(met.test) + " tests";
  if (!selects && !met.validation.empty()) message += (tests ? " " : ", ") + JoinTexts(met.validation) + " selects";
  if (tests && met.validation.empty()) message = "the validation part is empty: all others test or train";
  findings.push_back(SplitFinding(options, "split_drawn", message, FindingAction::kRepaired));
  return ResolvedGroups{met, true};
}

}  // namespace mocurate
