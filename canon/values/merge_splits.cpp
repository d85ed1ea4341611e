#include "canon/values/merge_splits.h"

#include <algorithm>
#include <set>

#include "canon/splits/leaks.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

/// Properties that a split may separate. People of two sources with one name are two.
enum class GroupKind { kPerson, kStyle, kPerformance };
constexpr std::pair<GroupKind, const char*> kGroupKinds[] = {
    {GroupKind::kPerson, "person"}, {GroupKind::kStyle, "style"}, {GroupKind::kPerformance, "performance"}};

std::vector<std::string> GroupsOf(GroupKind kind, const std::vector<Clip>& clips) {
  std::vector<std::string> groups;
  for (const Clip& clip : clips) {
    if (kind == GroupKind::kPerson) groups.push_back(clip.identity.source + "/" + clip.identity.person);
    if (kind == GroupKind::kPerformance) groups.push_back(PerformanceOf(clip, false));
    if (kind == GroupKind::kStyle) {
      const auto style = clip.provenance.find("style");
      groups.push_back(style == clip.provenance.end() ? "" : style->second);
    }
  }
  return groups;
}

/// Groups of this type that are in two parts.
std::vector<std::string> SharedGroups(GroupKind kind, const std::vector<int>& parts, const std::vector<Clip>& clips) {
  std::vector<std::string> shared;
  for (const auto& [group, rows] : InTwoParts(parts, GroupsOf(kind, clips))) shared.push_back(group);
  return shared;
}

Finding AboutSplit(const char* code, Severity severity, double value, const std::string& message,
                   FindingAction action) {
  Finding finding;
  finding.code = code;
  finding.severity = severity;
  finding.value = value;
  finding.message = message;
  finding.action = action;
  return finding;
}

/// A part, and its own split.
using SplitOfPart = std::pair<std::size_t, const Split*>;

std::string RuleOf(const std::vector<MergePart>& parts, const std::vector<SplitOfPart>& splits) {
  std::set<std::string> rules;
  std::string all;
  for (const auto& [p, split] : splits) {
    rules.insert(split->rule);
    all += (all.empty() ? "" : "; ") + parts[p].name + ": " + split->rule;
  }
  return rules.size() == 1 ? *rules.begin() : all;
}

/// The clips' source data, or their motions where that is unknown or several people's.
Expected<std::vector<std::string>> ContentsOf(const std::vector<MergePart>& parts, const MergedDataset& merged) {
  std::vector<std::string> motions(merged.origins.size());
  std::vector<std::size_t> sets;
  const std::vector<bool> needed = DistinguishedByMotion(merged.dataset.clips);
  for (std::size_t row = 0; row < merged.origins.size(); ++row) {
    const auto [p, row_there] = merged.origins[row];
    sets.push_back(p);
    if (!needed[row]) continue;
    auto hash = parts[p].motion_hash(row_there);
    if (!hash) return Forward(hash);
    motions[row] = std::move(*hash);
  }
  return ContentsOf(merged.dataset.clips, motions, sets);
}

/// Checks the united split again, for all properties that each of the splits separates; leaks reported by a split stay.
std::string CheckUnited(const std::vector<MergePart>& parts, const std::vector<SplitOfPart>& splits,
                        const std::vector<int>& part_of_row, const std::vector<Clip>& clips,
                        const std::vector<std::string>& contents) {
  Leaks leaks;
  leaks.repeated = InTwoParts(part_of_row, contents).size();
  std::string apart;
  for (const auto& [kind, name] : kGroupKinds) {
    const bool kept_apart = std::all_of(splits.begin(), splits.end(), [&, k = kind](const SplitOfPart& one) {
      const std::vector<Clip>& own = parts[one.first].dataset.clips;
      return SharedGroups(k, PartsOf(*one.second, own.size()), own).empty();
    });
    const std::vector<std::string> groups = GroupsOf(kind, clips);
    const bool known = std::any_of(groups.begin(), groups.end(), [](const std::string& g) { return !g.empty(); });
    if (!kept_apart || !known) continue;
    apart += (apart.empty() ? "" : ", ") + std::string(name);
    for (std::string& group : SharedGroups(kind, part_of_row, clips)) leaks.groups.push_back(std::move(group));
  }
  std::string text = LeakText(apart, leaks);
  for (const auto& [p, split] : splits) {
    if (split->leak_check.rfind("ok", 0) == 0) continue;
    text = (text.rfind("ok", 0) == 0 ? "leaks:" : text + ";") + " in " + parts[p].name + ": " + split->leak_check;
  }
  return text;
}

/// Number of clips, of parts that lack a split, that are in no part of it.
void ReportAbsent(const std::vector<MergePart>& parts, const std::vector<SplitOfPart>& splits, const std::string& name,
                  std::vector<Finding>& findings) {
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const bool has = std::any_of(splits.begin(), splits.end(), [&](const SplitOfPart& one) { return one.first == p; });
    const std::size_t clips = parts[p].dataset.clips.size();
    if (has || clips == 0) continue;
    findings.push_back(AboutSplit("split_incomplete", Severity::kWarning, static_cast<double>(clips),
                                  "split '" + name + "' is missing in " + parts[p].name + ", whose " +
                                      Counted(static_cast<long long>(clips), "clip") + " are in no part of it",
                                  FindingAction::kFlagged));
  }
}

}  // namespace

Expected<std::vector<Split>> MergeSplits(const std::vector<MergePart>& parts, const MergedRows& new_rows,
                                         const MergedDataset& merged, std::vector<Finding>& findings) {
  std::map<std::string, std::vector<SplitOfPart>> by_name;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (const Split& split : parts[p].dataset.splits) by_name[split.name].emplace_back(p, &split);
  }
  std::vector<Split> united;
  if (by_name.empty()) return united;
  const std::vector<Clip>& clips = merged.dataset.clips;
  const auto contents = ContentsOf(parts, merged);
  if (!contents) return Forward(contents);
  for (const auto& [name, splits] : by_name) {
    ReportAbsent(parts, splits, name, findings);
    std::vector<int> part_of_row(clips.size(), -1);
    std::vector<std::size_t> decided_by(clips.size());
    for (const auto& [p, split] : splits) {
      const std::vector<int> own = PartsOf(*split, new_rows[p].size());
      for (std::size_t row = 0; row < own.size(); ++row) {
        if (own[row] < 0) continue;
        const auto at = static_cast<std::size_t>(new_rows[p][row]);
        if (part_of_row[at] < 0) {
          part_of_row[at] = own[row];
          decided_by[at] = p;
        } else if (part_of_row[at] != own[row]) {
          Finding finding =
              AboutSplit("split_part_differs", Severity::kWarning, 2.0,
                         "split '" + name + "': " + NameOfPart(part_of_row[at]) + " in " + parts[decided_by[at]].name +
                             ", " + NameOfPart(own[row]) + " in " + parts[p].name + "; kept in the first",
                         FindingAction::kKept);
          finding.clip = clips[at].id();
          findings.push_back(std::move(finding));
        }
      }
    }
    Split split;
    split.name = name;
    split.rule = RuleOf(parts, splits);
    for (std::size_t row = 0; row < clips.size(); ++row) {
      std::vector<int>* const of_part[] = {&split.train, &split.validation, &split.test};
      if (part_of_row[row] >= 0) of_part[part_of_row[row]]->push_back(static_cast<int>(row));
    }
    split.leak_check = CheckUnited(parts, splits, part_of_row, clips, *contents);
    if (split.leak_check.rfind("ok", 0) != 0) {
      findings.push_back(AboutSplit("split_leak", Severity::kError, 0.0, "split '" + name + "': " + split.leak_check,
                                    FindingAction::kFlagged));
    }
    united.push_back(std::move(split));
  }
  return united;
}

}  // namespace mocurate
