#include "canon/splits/splits.h"

#include <algorithm>
#include <map>
#include <set>

#include "canon/splits/groups.h"
#include "canon/splits/leaks.h"
#include "core/base/random.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

using Part = std::vector<int> Split::*;

std::string GroupOf(const SplitOptions& options, const Clip& clip) {
  return GroupOf(options.by, clip, options.sessions_together);
}

Part PartOf(const SplitOptions& options, const std::string& group, const Clip& clip) {
  if (options.by == SplitBy::kRole) {
    return clip.role == "test" ? &Split::test : clip.role == "validation" ? &Split::validation : &Split::train;
  }
  if (options.by == SplitBy::kFraction) {
    const double draw = Random(static_cast<std::uint64_t>(options.seed), "split", group).Uniform();
    if (draw < options.test_share) return &Split::test;
    return draw < options.test_share + options.validation_share ? &Split::validation : &Split::train;
  }
  const auto names = [&](const std::vector<std::string>& part) {
    return std::find(part.begin(), part.end(), group) != part.end();
  };
  return names(options.test) ? &Split::test : names(options.validation) ? &Split::validation : &Split::train;
}

std::string RuleHead(SplitBy by) { return std::string("by ") + NameOf(by); }

std::string RuleText(const SplitOptions& options, bool drawn) {
  std::string text = RuleHead(options.by);
  if (drawn) text += ", drawn where the set has none of the named ones";
  if (NamesGroups(options.by)) {
    text += options.test.empty() ? "; no test part" : "; test: " + JoinTexts(options.test);
    if (!options.validation.empty()) text += "; validation: " + JoinTexts(options.validation);
  }
  return text;
}

/// A split by role of clips without any: with `absent: refuse` an error kConfig, else a finding, and all train.
Status CheckRoles(const SplitOptions& options, const Dataset& dataset, std::vector<Finding>& findings) {
  const auto has_role = [](const Clip& clip) { return !clip.role.empty(); };
  if (options.by != SplitBy::kRole || std::any_of(dataset.clips.begin(), dataset.clips.end(), has_role)) return {};
  const std::string what = "no clip has a role, so that all train";
  if (options.absent == AbsentGroups::kRefuse) {
    return Fail(ErrorCode::kConfig, what, "assemble.splits." + options.name,
                "declare ingest.source.roles or annotation_roles, or split by: person");
  }
  findings.push_back(
      MakeFinding("split_name_absent", Severity::kWarning, 0.0, "split '" + options.name + "': " + what));
  return {};
}

/// Groups (persons, styles, recordings) and clips of equal content that are in two parts.
std::string LeakCheck(const SplitOptions& options, const Dataset& dataset, const std::vector<int>& parts,
                      const std::vector<std::string>& hashes) {
  std::vector<std::string> groups, shared;
  for (const Clip& clip : dataset.clips) groups.push_back(GroupOf(options, clip));
  for (const auto& [group, rows] : InTwoParts(parts, groups)) shared.push_back(group);
  const std::string what = options.by == SplitBy::kRole ? "performance" : NameOf(options.by);
  return LeakText(what, shared, InTwoParts(parts, ContentsOf(dataset.clips, hashes)).size());
}

/// Limits the clips of each label in a part to those whose ids hash lowest. Returns the number removed.
long long TakeAtMost(std::int64_t most, std::int64_t seed, const Dataset& dataset, std::vector<int>& part) {
  std::map<std::string, std::vector<std::pair<double, int>>> by_label;
  for (const int row : part) {
    const Clip& clip = dataset.clips[static_cast<std::size_t>(row)];
    by_label[clip.label].emplace_back(Random(static_cast<std::uint64_t>(seed), "split.quota", clip.id()).Uniform(),
                                      row);
  }
  const std::size_t before = part.size();
  part.clear();
  for (auto& [label, rows] : by_label) {
    std::sort(rows.begin(), rows.end());
    const auto taken = std::min<std::size_t>(rows.size(), static_cast<std::size_t>(most));
    for (std::size_t i = 0; i < taken; ++i) part.push_back(rows[i].second);
  }
  std::sort(part.begin(), part.end());
  return static_cast<long long>(before - part.size());
}

}  // namespace

std::optional<SplitBy> KeptApart(const Split& split) {
  std::optional<SplitBy> found;
  for (const SplitBy by : {SplitBy::kPerson, SplitBy::kStyle, SplitBy::kFraction, SplitBy::kRole}) {
    const std::string rule = RuleHead(by);
    const bool named =
        split.rule.compare(0, rule.size(), rule) == 0 || split.rule.find(": " + rule) != std::string::npos;
    if (named && found) return std::nullopt;  // parts of different rules
    if (named) found = by;
  }
  return found;
}

Expected<Split> MakeSplit(const SplitOptions& options, const Dataset& dataset, std::vector<Finding>& findings,
                          const std::vector<std::string>& contents) {
  SplitOptions met = options;
  bool drawn = false;
  if (Status sound = CheckSplit(options); !sound) return Forward(sound);
  if (Status roles = CheckRoles(options, dataset, findings); !roles) return Forward(roles);
  if (NamesGroups(options.by)) {
    std::set<std::string> groups;
    for (const Clip& clip : dataset.clips) groups.insert(GroupOf(options, clip));
    auto possible = ResolveGroups(options, groups, findings);
    if (!possible) return Forward(possible);
    met = std::move(possible->options);
    drawn = possible->drawn;
  }
  Split split;
  split.name = options.name;
  split.rule = RuleText(met, drawn);
  long long too_short = 0;
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    const Clip& clip = dataset.clips[i];
    const Part part = PartOf(met, GroupOf(met, clip), clip);
    if (part == &Split::train && clip.motion->frame_count() < options.min_train_frames) {
      ++too_short;
      continue;
    }
    (split.*part).push_back(static_cast<int>(i));
  }
  if (options.most_per_label > 0) {
    long long beyond = 0;
    for (std::vector<int>* rows : {&split.train, &split.validation, &split.test}) {
      beyond += TakeAtMost(options.most_per_label, options.seed, dataset, *rows);
    }
    split.rule += "; at most " + Counted(options.most_per_label, "clip") + " of a label in each part, " +
                  std::to_string(beyond) + " left aside";
  }
  if (too_short > 0) {
    split.rule += "; " + Counted(too_short, "training clip") + " shorter than " +
                  Counted(options.min_train_frames, "frame") + " left aside";
  }
  split.leak_check = LeakCheck(met, dataset, PartsOf(split, dataset.clips.size()), contents);
  return split;
}

}  // namespace mocurate
