#include "canon/values/relabel.h"

#include <algorithm>
#include <optional>
#include <set>

#include "canon/values/subset.h"
#include "core/base/text.h"
#include "core/base/version.h"

namespace mocurate {
namespace {

constexpr std::size_t kMostNearest = 10;       // names without a match that get a suggestion
constexpr std::size_t kMostRuleTests = 10000;  // of all rules

using Names = std::set<std::string>;

bool IsNamed(const Names& names, const std::string& name) { return names.count(name) > 0; }

Finding AboutLabel(const char* code, Severity severity, std::size_t value, const std::string& message,
                   FindingAction action) {
  return MakeFinding(code, severity, static_cast<double>(value), message, action);
}

std::string MeantText(const std::optional<std::string>& nearest) {
  return nearest ? "; the nearest is '" + *nearest + "'" : "";
}

/// The map, restricted to labels that the dataset has.
std::string NewLabel(const RelabelMap& map, const std::string& label) {
  const auto found = map.labels.find(label);
  return found == map.labels.end() ? label : found->second;
}

/// Names of the map that match nothing, each as a finding. Error kConfig where nothing matches.
Status ReportUnknown(const RelabelMap& map, const Dataset& dataset, std::vector<Finding>& findings) {
  std::set<std::string> present(dataset.labels.begin(), dataset.labels.end());
  std::set<std::string> ids;
  for (const Clip& clip : dataset.clips) {
    present.insert(clip.label);
    ids.insert(clip.id());
    for (const Segment& segment : clip.segments) present.insert(segment.label);
  }
  present.erase("");
  const std::vector<std::string> known(present.begin(), present.end());
  std::vector<std::string> named = map.drop;
  for (const auto& [old_label, new_label] : map.labels) named.push_back(old_label);
  std::size_t fitting = map.rules.size() + map.classes.size();
  for (const std::string& label : named) {
    if (present.count(label) > 0 || label.empty()) {
      ++fitting;
      continue;
    }
    const auto near = findings.size() < kMostNearest ? Nearest(label, known) : std::nullopt;
    findings.push_back(AboutLabel("unknown_label", Severity::kWarning, 0,
                                  "no clip has the label '" + label + "' of " + map.name + MeantText(near),
                                  FindingAction::kExcluded));
  }
  std::vector<std::string> unknown;
  for (const auto& [clip, label] : map.table) {
    if (ids.count(clip) == 0) unknown.push_back(clip);
  }
  fitting += map.table.size() - unknown.size();
  if (!unknown.empty()) {
    const auto near = Nearest(unknown[0], {ids.begin(), ids.end()});
    findings.push_back(
        AboutLabel("unknown_clip", Severity::kWarning, unknown.size(),
                   "the dataset has no clip '" + unknown[0] + "' of " + map.name + MeantText(near) +
                       (unknown.size() > 1 ? ", nor " + std::to_string(unknown.size() - 1) + " others" : ""),
                   FindingAction::kExcluded));
  }
  if (fitting > 0) return {};
  return Fail(ErrorCode::kConfig, "nothing in it matches the dataset: " + findings.front().message, map.name,
              "list the labels of a dataset with mocurate dataset card");
}

/// The new label of each clip; empty optional: the clip is removed.
Expected<std::vector<std::optional<std::string>>> NewLabels(const RelabelMap& map, const Names& drop,
                                                            const Dataset& dataset) {
  std::vector<std::optional<std::string>> labels(dataset.clips.size());
  std::vector<bool> decided(labels.size(), false);
  for (std::size_t row = 0; row < labels.size(); ++row) {
    const auto named = map.table.find(dataset.clips[row].id());
    if (named == map.table.end()) continue;
    labels[row] = named->second;
    decided[row] = true;
  }
  std::size_t tests = 0;
  for (const RelabelRule& rule : map.rules) {
    const auto condition = Condition::Parse(rule.where, rule.place + ":where");
    const auto holds = condition ? condition->Holds(dataset) : tl::unexpected<Error>(condition.error());
    if (!holds) return Fail(ErrorCode::kConfig, holds.error().what, holds.error().where, holds.error().hint);
    tests += condition->tests();
    if (tests > kMostRuleTests) {
      return Fail(ErrorCode::kConfig, "the rules compare more than " + std::to_string(kMostRuleTests) + " times",
                  rule.place, "compare with lists (id in [a, b]), or list the clips in a table under clips");
    }
    for (std::size_t row = 0; row < labels.size(); ++row) {
      if (decided[row] || !(*holds)[row]) continue;
      labels[row] = rule.label;
      decided[row] = true;
    }
  }
  for (std::size_t row = 0; row < labels.size(); ++row) {
    const std::string& label = dataset.clips[row].label;
    if (!decided[row] && !IsNamed(drop, label)) labels[row] = NewLabel(map, label);
  }
  return labels;
}

/// Classes in their new order.
Expected<std::vector<std::string>> NewClasses(const RelabelMap& map, const Names& drop, const Dataset& dataset,
                                              const std::vector<std::optional<std::string>>& of_clips) {
  std::vector<std::string> classes = map.classes;
  Names listed(classes.begin(), classes.end());
  if (!classes.empty()) {
    std::map<std::string, std::size_t> lacking;
    for (std::size_t row = 0; row < of_clips.size(); ++row) {
      if (of_clips[row] && !of_clips[row]->empty() && !IsNamed(listed, *of_clips[row])) ++lacking[*of_clips[row]];
    }
    if (lacking.empty()) return classes;
    const auto& [label, clips] = *lacking.begin();
    return Fail(ErrorCode::kConfig,
                "classes does not list '" + label + "', which " + Counted(static_cast<long long>(clips), "clip") +
                    (clips == 1 ? " has" : " have"),
                map.name, DidYouMean(label, classes, "list it, rename it under labels, or drop it"));
  }
  const auto add = [&](const std::string& label) {
    if (!label.empty() && listed.insert(label).second) classes.push_back(label);
  };
  for (const std::string& label : dataset.labels) {
    if (!IsNamed(drop, label)) add(NewLabel(map, label));
  }
  for (const RelabelRule& rule : map.rules) add(rule.label);
  const std::set<std::string> used = [&] {
    std::set<std::string> labels;
    for (const auto& label : of_clips) labels.insert(label.value_or(""));
    return labels;
  }();
  for (const auto& [clip, label] : map.table) {
    if (used.count(label) > 0) add(label);
  }
  return classes;
}

/// Fine labels follow their classes; those of a removed class are removed.
std::vector<FineLabel> NewFineLabels(const RelabelMap& map, const Names& drop, const Dataset& before,
                                     const std::vector<std::string>& classes) {
  std::map<std::string, int> index_of;
  for (std::size_t c = 0; c < classes.size(); ++c) index_of.emplace(classes[c], static_cast<int>(c));
  std::vector<FineLabel> fine_labels;
  for (const FineLabel& fine : before.fine_labels) {
    const std::string& parent = before.labels[static_cast<std::size_t>(fine.parent)];
    const auto at = index_of.find(NewLabel(map, parent));
    if (drop.count(parent) > 0 || at == index_of.end()) continue;
    fine_labels.push_back({fine.name, at->second});
  }
  return fine_labels;
}

/// Labels of segments; returns how many changed or were removed.
std::size_t RelabelSegments(const RelabelMap& map, const Names& drop, std::vector<Segment>& segments) {
  std::size_t changed = 0;
  std::vector<Segment> kept;
  for (Segment& segment : segments) {
    const bool dropped = IsNamed(drop, segment.label);
    const std::string label = NewLabel(map, segment.label);
    changed += dropped || label != segment.label ? 1 : 0;
    if (dropped) continue;
    segment.label = label;
    kept.push_back(std::move(segment));
  }
  segments = std::move(kept);
  return changed;
}

void ReportChanges(RelabelledDataset& relabelled, const std::map<std::string, std::size_t>& dropped,
                   std::size_t cleared) {
  for (const auto& [labels, clips] : relabelled.changes) {
    const std::string count = Counted(static_cast<long long>(clips), "clip");
    relabelled.findings.push_back(AboutLabel("relabelled", Severity::kInfo, clips,
                                             "'" + labels.first + "' became '" + labels.second + "': " + count,
                                             FindingAction::kRepaired));
  }
  for (const auto& [label, clips] : dropped) {
    relabelled.findings.push_back(AboutLabel("dropped", Severity::kInfo, clips,
                                             "label '" + label + "': " + Counted(static_cast<long long>(clips), "clip"),
                                             FindingAction::kDropped));
  }
  if (cleared > 0) {
    relabelled.findings.push_back(AboutLabel(
        "fine_label_cleared", Severity::kInfo, cleared,
        Counted(static_cast<long long>(cleared), "clip") + " had a fine label of another class than the new one",
        FindingAction::kRepaired));
  }
}

}  // namespace

Expected<RelabelledDataset> Relabel(Dataset dataset, const RelabelMap& map) {
  RelabelledDataset relabelled;
  if (Status fits = ReportUnknown(map, dataset, relabelled.findings); !fits) return Forward(fits);
  const Names drop(map.drop.begin(), map.drop.end());
  const auto labels = NewLabels(map, drop, dataset);
  if (!labels) return Forward(labels);
  const auto classes = NewClasses(map, drop, dataset, *labels);
  if (!classes) return Forward(classes);
  const std::vector<FineLabel> old_fine_labels = dataset.fine_labels;
  dataset.fine_labels = NewFineLabels(map, drop, dataset, *classes);
  dataset.labels = *classes;
  std::vector<bool> keep(labels->size());
  std::map<std::string, std::size_t> dropped;
  std::size_t cleared = 0;
  for (std::size_t row = 0; row < keep.size(); ++row) {
    Clip& clip = dataset.clips[row];
    const std::optional<std::string>& label = (*labels)[row];
    keep[row] = label.has_value();
    if (!label) {
      ++dropped[clip.label];
      continue;
    }
    relabelled.segments += RelabelSegments(map, drop, clip.segments);
    const bool listed = std::any_of(old_fine_labels.begin(), old_fine_labels.end(),
                                    [&](const FineLabel& fine) { return fine.name == clip.fine_label; });
    const bool other = *label != clip.label;
    if (other) ++relabelled.changes[{clip.label, *label}];
    clip.label = *label;
    const int fine = clip.fine_label.empty() ? -1 : dataset.FineLabelIndex(clip.fine_label);
    const bool fits =
        fine >= 0 && dataset.LabelIndex(clip.label) == dataset.fine_labels[static_cast<std::size_t>(fine)].parent;
    if (clip.fine_label.empty() || fits || (!listed && !other)) continue;
    clip.fine_label.clear();
    ++cleared;
  }
  const std::vector<Split> before = dataset.splits;
  relabelled.rows = KeepRows(keep, dataset);
  if (dataset.clips.empty()) {
    return Fail(ErrorCode::kInconsistent, "every clip is dropped", map.name, "keep at least one label");
  }
  if (!dropped.empty()) NoteEarlierChecks("labels were dropped", dataset);
  ReportChanges(relabelled, dropped, cleared);
  for (Finding& empty : FindEmptyParts(before, dataset.splits)) relabelled.findings.push_back(std::move(empty));
  AddToRecipe("relabelled by " + map.name, dataset);
  for (const Finding& finding : relabelled.findings) {
    if (finding.severity == Severity::kInfo) AddToRecipe("- " + finding.message, dataset);
  }
  dataset.created_by = CreatedBy();
  dataset.findings.insert(dataset.findings.end(), relabelled.findings.begin(), relabelled.findings.end());
  relabelled.dataset = std::move(dataset);
  return relabelled;
}

}  // namespace mocurate
