#include "canon/values/subset.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "canon/splits/leaks.h"
#include "core/base/text.h"
#include "core/base/version.h"

namespace mocurate {
namespace {

/// The frame after the last of a clip, of its id; 0 where the id has no frames.
int SpanEnd(const std::string& id) {
  const std::size_t dash = id.find('-', id.rfind('#') == std::string::npos ? 0 : id.rfind('#'));
  return dash == std::string::npos ? 0
                                   : static_cast<int>(ParseInteger(std::string_view(id).substr(dash + 1)).value_or(0));
}

/// "label == wave: 12, frames >= 60: 0 of 180 clips"
std::string TestCountsText(const std::vector<std::pair<std::string, std::size_t>>& counts, std::size_t clips) {
  std::string text;
  for (const auto& [test, count] : counts) text += (text.empty() ? "" : ", ") + test + ": " + std::to_string(count);
  return text + " of " + Counted(static_cast<long long>(clips), "clip");
}

/// Removes labels and fine labels without a clip; the others are renumbered.
void DropEmptyLabels(Dataset& dataset) {
  std::set<std::string> used, used_fine;
  for (const Clip& clip : dataset.clips) {
    used.insert(clip.label);
    used_fine.insert(clip.fine_label);
  }
  std::vector<std::string> labels;
  std::vector<int> new_class(dataset.labels.size(), -1);
  for (std::size_t i = 0; i < dataset.labels.size(); ++i) {
    if (used.count(dataset.labels[i]) == 0) continue;
    new_class[i] = static_cast<int>(labels.size());
    labels.push_back(dataset.labels[i]);
  }
  std::vector<FineLabel> fine_labels;
  for (const FineLabel& fine : dataset.fine_labels) {
    const int parent = new_class[static_cast<std::size_t>(fine.parent)];
    if (parent >= 0 && used_fine.count(fine.name) > 0) fine_labels.push_back({fine.name, parent});
  }
  dataset.labels = std::move(labels);
  dataset.fine_labels = std::move(fine_labels);
}

/// "by_person (train), fold 2 (test)": the parts of splits that a row is in.
std::string PartsText(const std::vector<Split>& splits, int row) {
  std::string text;
  for (const Split& split : splits) {
    const std::pair<const char*, const std::vector<int>*> parts[] = {
        {"train", &split.train}, {"validation", &split.validation}, {"test", &split.test}};
    for (const auto& [name, rows] : parts) {
      if (std::find(rows->begin(), rows->end(), row) == rows->end()) continue;
      text += (text.empty() ? "" : ", ") + split.name + " (" + name + ")";
    }
  }
  return text;
}

Finding NotFitted(const std::string& id, const std::string& reason, const std::string& parts) {
  return MakeFinding("clip_not_fitted", Severity::kError, 0.0,
                     reason + (parts.empty() ? "" : "; it left the splits " + parts), FindingAction::kDropped, id);
}

/// What the clip was before, with its new motion. Where its source data is unknown, it stays so.
Clip Refitted(const Clip& before, Clip fit) {
  fit.evidence_sha256 = before.evidence_sha256;
  if (fit.fit_rms == 0.0) fit.fit_rms = before.fit_rms;  // a given motion with other feet
  for (const char* key : {"file", "source_axes", "source_units", "source_skeleton"}) {
    const auto own = before.provenance.find(key);
    if (own != before.provenance.end()) fit.provenance[key] = own->second;
  }
  return fit;
}

}  // namespace

std::optional<int> FirstFrameOfId(const std::string& id) {
  const std::size_t hash = id.rfind('#');
  if (hash == std::string::npos) return std::nullopt;
  const auto begin = ParseInteger(std::string_view(id).substr(hash + 1, id.find('-', hash) - hash - 1));
  return begin ? std::optional<int>(static_cast<int>(*begin)) : std::nullopt;
}

bool IsAbout(const Finding& finding, const Clip& clip) {
  if (finding.clip == clip.id()) return true;
  if (RecordingOf(finding.clip) != RecordingOf(clip.id())) return false;
  const auto begin = FirstFrameOfId(finding.clip);
  if (!begin) return true;
  const ClipIdentity& identity = clip.identity;
  const bool whole = *begin <= identity.begin_frame && SpanEnd(finding.clip) >= identity.end_frame;
  if (!whole || finding.frame_end <= finding.frame_begin) return whole;
  const int from = *begin + finding.frame_begin, to = *begin + finding.frame_end;
  return from < identity.end_frame && to > identity.begin_frame;
}

std::vector<std::size_t> KeepRows(const std::vector<bool>& keep, Dataset& dataset) {
  std::vector<std::size_t> rows;
  std::vector<int> new_row(keep.size(), -1);
  std::vector<Clip> kept;
  std::set<std::string> gone;
  for (std::size_t row = 0; row < keep.size(); ++row) {
    if (!keep[row]) {
      gone.insert(dataset.clips[row].id());
      continue;
    }
    new_row[row] = static_cast<int>(rows.size());
    rows.push_back(row);
    kept.push_back(std::move(dataset.clips[row]));
  }
  dataset.clips = std::move(kept);
  for (Split& split : dataset.splits) MoveRows(new_row, split);
  // Findings about whole recordings stay while one of their clips does.
  std::set<std::string> recordings;
  for (const Clip& clip : dataset.clips) recordings.insert(RecordingOf(clip.id()));
  std::vector<Finding> findings;
  for (Finding& finding : dataset.findings) {
    const bool stays = finding.clip.empty() || recordings.count(RecordingOf(finding.clip)) != 0;
    if (stays && gone.count(finding.clip) == 0) findings.push_back(std::move(finding));
  }
  dataset.findings = std::move(findings);
  return rows;
}

void AddFindings(const std::vector<Finding>& more, std::vector<Finding>& all) {
  std::map<std::pair<std::string, std::string>, std::vector<std::size_t>> known;  // clip, code -> places in all
  const std::size_t before = all.size();
  for (std::size_t i = 0; i < before; ++i) known[{all[i].clip, all[i].code}].push_back(i);
  for (const Finding& finding : more) {
    const std::vector<std::size_t>& alike = known[{finding.clip, finding.code}];
    const bool there = std::any_of(alike.begin(), alike.end(), [&](std::size_t at) { return all[at] == finding; });
    if (!there) all.push_back(finding);
  }
}

std::vector<Finding> FindEmptyParts(const std::vector<Split>& before, const std::vector<Split>& after) {
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const std::pair<const char*, std::vector<int> Split::*> parts[] = {
        {"train", &Split::train}, {"validation", &Split::validation}, {"test", &Split::test}};
    for (const auto& [name, part] : parts) {
      const std::size_t old = (before[i].*part).size();
      if (!(after[i].*part).empty() || old == 0) continue;
      findings.push_back(MakeFinding("empty_part", Severity::kWarning, static_cast<double>(old),
                                     "split '" + after[i].name + "': none of the " +
                                         Counted(static_cast<long long>(old), "clip") + " of its part " + name +
                                         " is left"));
    }
  }
  return findings;
}

void NoteEarlierChecks(const std::string& change, Dataset& dataset) {
  for (Split& split : dataset.splits) {
    if (split.leak_check.rfind("ok", 0) != 0) split.leak_check += " (before " + change + ")";
  }
}

void AddToRecipe(const std::string& line, Dataset& dataset) {
  if (!dataset.recipe.empty() && dataset.recipe.back() != '\n') dataset.recipe += '\n';
  dataset.recipe += line + '\n';
}

Expected<ChangedDataset> SubsetOf(Dataset dataset, const Condition& condition, const std::string& name,
                                  bool drop_empty_labels) {
  const auto holds = condition.Holds(dataset);
  if (!holds) return Forward(holds);
  const auto count = static_cast<std::size_t>(std::count(holds->begin(), holds->end(), true));
  if (count == 0) {
    const auto counts = condition.CountTests(dataset);
    if (!counts) return Forward(counts);
    std::string nearest;
    for (const Condition::UnknownValue& unknown : condition.FindUnknownValues(dataset)) {
      if (unknown.nearest) nearest += (nearest.empty() ? "" : ", ") + unknown.value + " -> " + *unknown.nearest;
    }
    return Fail(ErrorCode::kInconsistent, "the condition matches no clip; " + TestCountsText(*counts, holds->size()),
                name, nearest.empty() ? "widen the condition" : "did you mean: " + nearest);
  }
  const std::vector<Split> before = dataset.splits;
  ChangedDataset subset;
  subset.rows = KeepRows(*holds, dataset);
  if (count < holds->size()) NoteEarlierChecks("clips were chosen", dataset);
  subset.findings = FindEmptyParts(before, dataset.splits);
  if (drop_empty_labels) DropEmptyLabels(dataset);
  AddToRecipe("subset of " + name + ": " + std::to_string(count) + " of " +
                  Counted(static_cast<long long>(holds->size()), "clip") + " where " + condition.text(),
              dataset);
  dataset.created_by = CreatedBy();
  dataset.findings.insert(dataset.findings.end(), subset.findings.begin(), subset.findings.end());
  subset.dataset = std::move(dataset);
  return subset;
}

ChangedDataset RefitDataset(Dataset before, Dataset fits, const std::map<std::string, std::string>& failed,
                            const std::string& how) {
  ChangedDataset refitted;
  std::map<std::string, Clip*> fit_of;
  for (Clip& clip : fits.clips) fit_of[clip.id()] = &clip;
  std::vector<bool> keep;
  for (std::size_t row = 0; row < before.clips.size(); ++row) {
    const std::string id = before.clips[row].id();
    keep.push_back(fit_of.count(id) > 0);
    const auto reason = failed.find(id);
    if (keep.back() || reason == failed.end()) continue;
    refitted.findings.push_back(NotFitted(id, reason->second, PartsText(before.splits, static_cast<int>(row))));
  }
  const std::vector<Split> splits = before.splits;
  refitted.rows = KeepRows(keep, before);
  if (refitted.rows.size() < keep.size()) NoteEarlierChecks("clips were fitted", before);
  for (Finding& empty : FindEmptyParts(splits, before.splits)) refitted.findings.push_back(std::move(empty));
  std::set<std::string> renamed;
  for (Clip& clip : before.clips) {
    clip = Refitted(clip, std::move(*fit_of.at(clip.id())));
    if (!clip.label.empty() && before.LabelIndex(clip.label) < 0) renamed.insert(clip.label);
  }
  before.labels.insert(before.labels.end(), renamed.begin(), renamed.end());
  before.skeleton = fits.skeleton;
  before.joints_only = fits.joints_only;
  AddFindings(fits.findings, before.findings);
  AddFindings(refitted.findings, before.findings);
  AddToRecipe(how, before);
  before.created_by = CreatedBy();
  refitted.dataset = std::move(before);
  return refitted;
}

}  // namespace mocurate
