#include "canon/audit/set_errors.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <map>
#include <optional>
#include <set>

#include "canon/splits/groups.h"
#include "canon/splits/leaks.h"
#include "canon/splits/splits.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

AuditFinding OfSet(const char* code, const std::string& message) {
  AuditFinding found;
  found.finding.code = code;
  found.finding.message = message;
  found.finding.action = FindingAction::kFlagged;
  return found;
}

/// A name without blanks and case.
std::string Plain(const std::string& name) {
  std::string plain;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isspace(byte) == 0) plain += static_cast<char>(std::tolower(byte));
  }
  return plain;
}

std::set<std::string> LabelsOf(const Dataset& dataset, const std::vector<int>& rows) {
  std::set<std::string> labels;
  for (const int row : rows) labels.insert(dataset.clips[static_cast<std::size_t>(row)].label);
  return labels;
}

/// "3 clips in train (ID), 1 clip in test (ID)".
std::string PartsText(const Dataset& dataset, const RowsByPart& rows) {
  std::string text;
  for (const auto& [part, of_part] : rows) {
    text += (text.empty() ? "" : ", ") + Counted(static_cast<long long>(of_part.size()), "clip") + " in " +
            NameOfPart(part) + " (" + dataset.clips[of_part.front()].id() + ")";
  }
  return text;
}

/// About a group that is in two parts of a split, with a clip of either.
AuditFinding SharedGroup(const Dataset& dataset, const Split& split, const RowsByPart& rows,
                         const std::string& message) {
  const auto &first = *rows.begin(), &second = *std::next(rows.begin());
  AuditFinding found = OfSet("split_leak", message + PartsText(dataset, rows));
  found.finding.clip = dataset.clips[first.second.front()].id();
  found.suggested = dataset.clips[second.second.front()].id();
  found.parts = {{split.name, NameOfPart(first.first), NameOfPart(second.first)}};
  return found;
}

/// Persons, styles or performances in two parts of a split.
void AddSharedGroups(const Dataset& dataset, const Split& split, std::vector<AuditFinding>& findings) {
  const std::optional<SplitBy> apart = KeptApart(split);
  const SplitBy by = apart.value_or(SplitBy::kPerson);
  std::vector<std::string> groups;
  for (const Clip& clip : dataset.clips) {
    const std::string group = GroupOf(by, clip, false);
    groups.push_back(by == SplitBy::kPerson && !group.empty() ? clip.identity.source + "/" + group : group);
  }
  const std::set<std::string> all(groups.begin(), groups.end());
  const auto shared = InTwoParts(PartsOf(split, dataset.clips.size()), groups);
  if (shared.empty()) return;
  if (!apart) {
    findings.push_back(SharedGroup(dataset, split, shared.begin()->second,
                                   "split '" + split.name + "' has " + std::to_string(shared.size()) + " of " +
                                       Counted(static_cast<long long>(all.size()), "person") +
                                       " in two parts, and its rule '" + split.rule +
                                       "' does not say whether it may; " + shared.begin()->first + ": "));
    findings.back().finding.value = static_cast<double>(shared.size());
    return;
  }
  const std::string kind = by == SplitBy::kPerson || by == SplitBy::kStyle ? NameOf(by) : "performance";
  for (const auto& [group, rows] : shared) {
    findings.push_back(
        SharedGroup(dataset, split, rows, kind + " '" + group + "' is in two parts of split '" + split.name + "': "));
    findings.back().finding.severity = Severity::kError;
    findings.back().finding.value = static_cast<double>(rows.size());
  }
}

}  // namespace

std::vector<AuditFinding> FindSetErrors(const Dataset& dataset) {
  std::vector<AuditFinding> findings;
  for (const Split& split : dataset.splits) {
    AddSharedGroups(dataset, split, findings);
    const std::set<std::string> trained = LabelsOf(dataset, split.train);
    for (const auto& [part, rows] : {std::pair("validates", &split.validation), std::pair("tests", &split.test)}) {
      for (const std::string& label : LabelsOf(dataset, *rows)) {
        if (trained.count(label) > 0) continue;
        findings.push_back(
            OfSet("class_not_trained", "split '" + split.name + "' " + part + " class '" + label +
                                           "', which has no training clip: change the split, or remove it "
                                           "from assemble.classes"));
      }
    }
  }
  std::map<std::string, std::set<std::string>> persons;
  for (const Clip& clip : dataset.clips)
    persons[clip.identity.source + '\n' + Plain(clip.identity.person)].insert(clip.identity.person);
  for (const auto& [plain, names] : persons) {
    if (names.size() < 2) continue;
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "'" : ", '") + name + "'";
    findings.push_back(
        OfSet("names_alike", "persons " + all +
                                 " differ in case or blanks only: if they are the same, a split by person separates "
                                 "them; unify the names in the source"));
  }
  return findings;
}

}  // namespace mocurate
