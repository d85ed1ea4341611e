#include "canon/values/subset.h"

#include <algorithm>
#include <set>

#include "core/base/version.h"

namespace mocurate {
namespace {

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
