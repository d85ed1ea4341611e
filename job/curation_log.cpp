#include "job/curation_log.h"

#include <algorithm>

#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

const char* DecisionOf(const ClipRecord& clip) {
  if (clip.kept()) return "kept";
  if (clip.failed()) return "dropped";
  return clip.excluded() ? "excluded" : "undecided";  // the run ended before
}

/// The finding that ended the clip: the last one for an excluded clip, the one with action "refused" for a failure.
/// Null for a failure without a finding.
const Finding* RuleOf(const ClipRecord& clip, const ItemResult& stage) {
  const std::vector<Finding>& findings = stage.outcome.findings;
  if (clip.excluded()) return findings.empty() ? nullptr : &findings.back();
  for (const Finding& finding : findings) {
    if (finding.action == FindingAction::kRefused) return &finding;
  }
  return nullptr;
}

nlohmann::json LineOf(const ClipRecord& clip) {
  nlohmann::json line = {{"clip", clip.item}, {"decision", DecisionOf(clip)}};
  if (clip.has_error_finding()) line["suspect"] = true;
  if (clip.replaces_rotations()) line["replaces_rotations"] = true;
  const nlohmann::json evidence = clip.evidence.summary;
  if (const auto source = evidence.find("source_sha256"); source != evidence.end()) line["source_sha256"] = *source;
  for (const char* field : {"label", "label_text"}) {  // name of the rule that set the label, if any
    if (!evidence.contains("label_text")) break;
    line[field] = evidence.value(field, std::string());
  }
  if (!clip.evidence.sha256.empty()) line["evidence_sha256"] = clip.evidence.sha256;
  if (!clip.motion.sha256.empty()) line["motion_sha256"] = clip.motion.sha256;
  if (!clip.canonical.sha256.empty()) line["canonical_sha256"] = clip.canonical.sha256;
  if (const ItemResult* stage = clip.ended()) {
    line["stage"] = clip.ended_at();
    line["rule"] = clip.reason();
    line["reason"] = stage->outcome.error.Message();
    if (const Finding* rule = RuleOf(clip, *stage)) {
      line["value"] = nlohmann::json(*rule).at("value");
      if (stage->summary.contains("threshold")) line["threshold"] = stage->summary.at("threshold");
    }
  }
  line["findings"] = clip.findings();
  return line;
}

}  // namespace

std::string ClipsText(const ClipCounts& counts) {
  std::string text = Counted(counts.clips, "clip") + ", " + std::to_string(counts.kept) +
                     " kept, excluded by rule: " + std::to_string(counts.excluded) + ", " +
                     std::to_string(counts.failed) + " failed";
  if (counts.suspect > 0) text += ", " + std::to_string(counts.suspect) + " suspect";
  if (counts.undecided > 0) text += ", " + std::to_string(counts.undecided) + " undecided (the run ended before)";
  if (counts.folders > 0) text += "; " + Counted(counts.folders, "folder") + " skipped";
  if (counts.replaces_rotations > 0) {
    text += "; recorded rotations of " + Counted(counts.replaces_rotations, "clip") +
            " replaced by fitted ones (fitting.method: none keeps them)";
  }
  return text;
}

Status WriteCurationLog(const std::vector<ClipRecord>& clips, const std::filesystem::path& path) {
  std::vector<const ClipRecord*> sorted;
  for (const ClipRecord& clip : clips) sorted.push_back(&clip);
  std::sort(sorted.begin(), sorted.end(), [](const ClipRecord* a, const ClipRecord* b) { return a->item < b->item; });
  std::string text;
  for (const ClipRecord* clip : sorted) {
    text += LineOf(*clip).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  }
  return WriteFile(path, text);
}

}  // namespace mocurate
