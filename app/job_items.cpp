#include "app/job_items.h"

#include <algorithm>

#include "app/main_job.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/resources.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "ingest/discover.h"
#include "ingest/files_check.h"

namespace mocurate {
namespace {

bool HasArtifact(const ItemResult& item) { return !item.artifact.empty(); }

/// A stage looked at it and gave nothing on.
bool Ended(const ItemResult& item) { return !HasArtifact(item) && !HasArtifact(item.outcome.kind); }

nlohmann::json StageSummary(const StageReport& stage) {
  return {{"stage", stage.stage},     {"branch", stage.branch},     {"items", stage.items.size()},
          {"done", stage.done},       {"doubtful", stage.doubtful}, {"left_out", stage.left_out},
          {"refused", stage.refused}, {"crashed", stage.crashed}};
}

/// What each network was trained with stands beside what came of it.
nlohmann::json TrainingSummary(const TrainOptions& options, const JobResult& result) {
  nlohmann::json training = result.training;
  for (auto& [item, summary] : training.items()) {
    if (summary.contains("epochs")) summary["batch"] = options.recogniser.batch;
  }
  return training;
}

nlohmann::json ClipSummary(const ClipRecord& clip) {
  nlohmann::json summary = {{"item", clip.item},
                            {"kept", clip.kept()},
                            {"doubtful", clip.doubtful()},
                            {"ingest", clip.evidence.outcome.summary},
                            {"fitting", clip.motion.outcome.summary},
                            {"canon", clip.canonical.outcome.summary},
                            {"findings", nlohmann::json::array()}};
  for (const ItemResult* item : {&clip.evidence, &clip.motion, &clip.canonical}) {
    if (item == &clip.motion && clip.motion.sha256 == clip.evidence.sha256) continue;
    for (const Finding& finding : item->outcome.findings) summary["findings"].push_back(finding);
  }
  if (const ItemResult* stage = clip.ended()) {
    summary[clip.failed() ? "failure" : "left_out"] = {
        {"stage", clip.ended_at()}, {"code", clip.reason()}, {"message", stage->outcome.error.Message()}};
  }
  return summary;
}

}  // namespace

const ItemResult* ClipRecord::ended() const {
  for (const ItemResult* stage : {&evidence, &motion, &canonical}) {
    if (Ended(*stage)) return stage;
  }
  return nullptr;
}

std::string ClipRecord::ended_at() const {
  const ItemResult* stage = ended();
  if (stage == nullptr) return "";
  return stage == &evidence ? "ingest" : stage == &motion ? "fitting" : "canon";
}

bool ClipRecord::folder() const {
  const std::vector<Finding>& findings = evidence.outcome.findings;
  return evidence.artifact.empty() && !findings.empty() && findings.back().code == kFolderNotRead;
}

bool ClipRecord::doubtful() const {
  if (ended() != nullptr) return false;
  for (const ItemResult* stage : {&evidence, &motion, &canonical}) {
    for (const Finding& finding : stage->outcome.findings) {
      if (finding.severity == Severity::kError) return true;
    }
  }
  return false;
}

std::string ClipRecord::reason() const {
  const ItemResult* stage = ended();
  if (stage == nullptr) return "";
  const bool ruled = stage->outcome.kind == OutcomeKind::kLeftOut && !stage->outcome.findings.empty();
  return ruled ? stage->outcome.findings.back().code : std::string(Name(stage->outcome.error.code));
}

std::set<std::string> FindingCodes(const ClipRecord& clip) {
  std::set<std::string> codes;
  for (const ItemResult* stage : {&clip.evidence, &clip.motion, &clip.canonical}) {
    for (const Finding& finding : stage->outcome.findings) {
      if (finding.severity != Severity::kInfo) codes.insert(finding.code);
    }
  }
  return codes;
}

void CountClips(const std::vector<ClipRecord>& clips, JobResult& result) {
  for (const ClipRecord& clip : clips) {
    if (clip.folder()) {
      ++result.counts.folders;
      result.folders_failed += clip.failed() ? 1 : 0;
      continue;
    }
    for (const std::string& code : FindingCodes(clip)) ++result.findings[code];
    ++result.counts.clips;
    result.counts.doubtful += clip.doubtful() ? 1 : 0;
    ++(clip.kept()       ? result.counts.kept
       : clip.failed()   ? result.counts.failed
       : clip.left_out() ? result.counts.left_out
                         : result.counts.undecided);
  }
}

Error FirstReason(const std::vector<ClipRecord>& clips, ItemResult ClipRecord::*branch) {
  const ItemResult* first = nullptr;
  for (const ClipRecord& clip : clips) {
    const ItemResult* stage = clip.ended();
    if (branch == &ClipRecord::baseline && Ended(clip.baseline)) stage = &clip.baseline;
    if (stage != nullptr && !clip.folder() &&
        (first == nullptr || (IsFailure(stage->outcome.kind) && !IsFailure(first->outcome.kind))))
      first = stage;
  }
  if (first == nullptr) return {ErrorCode::kInconsistent, "none came this far", "", ""};
  const char* became = IsFailure(first->outcome.kind) ? "the first failed: " : "the first was left out by a rule: ";
  return {first->outcome.error.code, became + first->outcome.error.Message(), "", ""};
}

Finding ComparisonDropped(const std::string& why) {
  Finding finding;
  finding.code = "comparison_dropped";
  finding.message = "no comparison with the raw tracks (train.baseline): " + why;
  finding.action = "dropped";
  return finding;
}

void LogLeftOut(const std::vector<ItemResult>& files) {
  const auto key = [](const ItemResult& file) {
    return std::pair(file.outcome.findings.back().code, file.outcome.kind);
  };
  std::map<std::pair<std::string, OutcomeKind>, long long> counts;
  for (const ItemResult& file : files) ++counts[key(file)];
  for (const ItemResult& file : files) {
    long long& count = counts[key(file)];
    if (count == 0) continue;  // told with the first of its kind
    const Error& error = file.outcome.error;
    const bool named = error.where.empty() || error.where == file.item;
    std::string text =
        named ? Error{error.code, error.what, file.item, error.hint}.Message() : file.item + ": " + error.Message();
    const bool folder = file.outcome.findings.back().code == kFolderNotRead && !IsFailure(file.outcome.kind);
    if (count > 1 && !folder) {
      text = Counted(count, "file") + (IsFailure(file.outcome.kind) ? " refused (" : " left out (") + key(file).first +
             "; curation_log.jsonl lists them), the first: " + text;
      count = 0;
    }
    Log(folder ? LogLevel::kInfo : LogLevel::kWarning, text);
  }
}

std::vector<ClipRecord> RecordsOf(const std::vector<ItemSpec>& specs, const std::vector<ItemResult>& ingested,
                                  std::vector<ItemResult> left_out) {
  std::vector<ClipRecord> clips;
  clips.reserve(ingested.size() + left_out.size());
  for (std::size_t i = 0; i < ingested.size(); ++i) {
    ClipRecord clip;
    clip.item = ingested[i].item;
    clip.evidence = ingested[i];
    for (const StageInput& input : specs[i].inputs) {
      if (input.role == "depth") clip.depth.push_back(input);
    }
    clips.push_back(std::move(clip));
  }
  for (ItemResult& file : left_out) {
    ClipRecord clip;
    clip.item = file.item;
    clip.evidence = std::move(file);
    clips.push_back(std::move(clip));
  }
  return clips;
}

nlohmann::json WithNotes(nlohmann::json metrics, const JobOptions& options, const JobResult& result) {
  metrics["generator_training"] = result.training.value("Action2Motion", nlohmann::json());
  for (const std::string& note : TrainingNotes(options.train)) metrics["notes"].push_back(note);
  for (const auto& [network, error] : result.untrained) {
    metrics["notes"].push_back(network + " was not trained: " + error.Message());
  }
  metrics["nearest_neighbour"] = result.audit.value("nearest_neighbour", nlohmann::json());
  return metrics;
}

std::vector<Finding> UnmatchedDropLabels(const CanonOptions& options, const std::vector<ItemResult>& items) {
  std::set<std::string> known;
  for (const ItemResult& item : items) {
    for (const auto& label : item.outcome.summary.value("labels", std::vector<std::string>())) known.insert(label);
  }
  std::vector<Finding> findings;
  if (known.empty()) return findings;
  for (const std::string& label : options.trim.drop_labels) {
    if (known.count(label) == 0) findings.push_back(UnmatchedName("canon.trim.drop_labels", "label", label, known));
  }
  return findings;
}

StageInput InputFrom(const char* role, const ItemResult& item) { return {role, item.item, item.artifact, item.sha256}; }

StageInput SkeletonInput(const std::string& name_or_path) {
  std::string content;
  if (const auto resource = FindResource("skeletons/" + name_or_path + ".yaml")) {
    content = std::string(*resource);
  } else if (const auto file = ReadFile(name_or_path)) {
    content = *file;
  }
  return {"skeleton", name_or_path, name_or_path, Sha256Hex(content)};
}

std::optional<ItemSpec> DuplicatesItem(const std::vector<ClipRecord>& clips, const nlohmann::json& options) {
  ItemSpec item{"duplicates", options, {}};
  for (const ClipRecord& clip : clips) {
    if (HasArtifact(clip.evidence)) item.inputs.push_back(InputFrom("evidence", clip.evidence));
  }
  if (item.inputs.size() < 2) return std::nullopt;
  return item;
}

void NoteDuplicates(const ItemResult& found, std::vector<ClipRecord>& clips) {
  const nlohmann::json items = found.outcome.summary.value("items", nlohmann::json::array());
  const nlohmann::json dropped = found.outcome.summary.value("dropped", nlohmann::json::object());
  std::map<std::string, ClipRecord*> by_item;
  for (ClipRecord& clip : clips) by_item[clip.item] = &clip;
  for (std::size_t i = 0; i < items.size() && i < found.outcome.findings.size(); ++i) {
    const auto record = by_item.find(items[i].get<std::string>());
    if (record == by_item.end()) continue;
    StageOutcome& outcome = record->second->evidence.outcome;
    const Finding& finding = found.outcome.findings[i];
    outcome.findings.push_back(finding);
    if (finding.action != "dropped" || !HasArtifact(record->second->evidence)) continue;
    record->second->evidence.artifact.clear();
    outcome.kind = OutcomeKind::kLeftOut;
    outcome.summary["threshold"] = dropped.value(record->first, 0.0);
    outcome.error = Error{ErrorCode::kInconsistent, finding.message, record->first,
                          "ingest.source.checks.actions." + finding.code + ": report keeps such clips"};
  }
}

std::vector<ItemSpec> ProportionItems(const std::vector<ClipRecord>& clips, const nlohmann::json& options) {
  std::map<std::string, std::map<std::string, const ClipRecord*>> persons;
  for (const ClipRecord& clip : clips) {
    if (HasArtifact(clip.evidence)) persons[clip.person()][clip.item] = &clip;
  }
  std::vector<ItemSpec> items;
  for (const auto& [person, members] : persons) {
    std::vector<std::string> ids;
    for (const auto& [id, clip] : members) ids.push_back(id);
    ItemSpec item{person, options, {}};
    for (const std::string& id : ChooseProportionClips(ids)) {
      const ClipRecord& clip = *members.at(id);
      item.inputs.push_back(InputFrom("evidence", clip.evidence));
      item.inputs.insert(item.inputs.end(), clip.depth.begin(), clip.depth.end());
    }
    items.push_back(std::move(item));
  }
  return items;
}

FitItems FittingItems(std::vector<ClipRecord>& clips, const std::map<std::string, ItemResult>& persons,
                      const nlohmann::json& options) {
  FitItems fits;
  for (ClipRecord& clip : clips) {
    if (!HasArtifact(clip.evidence)) continue;
    const auto person = persons.find(clip.person());
    if (person == persons.end()) {
      clip.motion.outcome.kind = OutcomeKind::kRefused;
      clip.motion.outcome.error =
          Error{ErrorCode::kInconsistent, "nothing says who the person is", clip.item, "set ingest.source.person"};
    } else if (!HasArtifact(person->second)) {
      clip.motion.outcome = person->second.outcome;
    } else {
      ItemSpec item{
          clip.item, options, {InputFrom("evidence", clip.evidence), InputFrom("proportions", person->second)}};
      item.inputs.insert(item.inputs.end(), clip.depth.begin(), clip.depth.end());
      fits.items.push_back(std::move(item));
      fits.clips.push_back(&clip);
    }
  }
  return fits;
}

FitItems GivenMotionItems(std::vector<ClipRecord>& clips, const nlohmann::json& options) {
  FitItems given;
  for (ClipRecord& clip : clips) {
    if (!HasArtifact(clip.evidence)) continue;
    given.items.push_back({clip.item, options, {InputFrom("evidence", clip.evidence)}});
    given.clips.push_back(&clip);
  }
  return given;
}

std::optional<ItemSpec> FitErrorItem(const std::vector<ClipRecord>& clips, const std::vector<StageInput>& truth) {
  ItemSpec item{"fit_error", nlohmann::json::object(), truth};
  for (const ClipRecord& clip : clips) {
    if (!HasArtifact(clip.motion)) continue;
    item.inputs.push_back(InputFrom("fit", clip.motion));
    item.inputs.push_back(InputFrom("evidence", clip.evidence));
  }
  if (truth.empty() || item.inputs.size() == truth.size()) return std::nullopt;
  return item;
}

std::vector<const ClipRecord*> ClipsToDraw(const std::vector<ClipRecord>& clips, int count) {
  std::vector<const ClipRecord*> fitted;
  for (const ClipRecord& clip : clips) {
    if (HasArtifact(clip.motion)) fitted.push_back(&clip);
  }
  const auto residual = [](const ClipRecord* clip) {
    return clip->motion.outcome.summary.value("residual_rms_mm", 0.0);
  };
  std::sort(fitted.begin(), fitted.end(), [&](const ClipRecord* a, const ClipRecord* b) {
    return residual(a) != residual(b) ? residual(a) < residual(b) : a->item < b->item;
  });
  std::vector<const ClipRecord*> chosen;
  const std::size_t wanted = std::min(fitted.size(), static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < wanted; ++i) {
    chosen.push_back(fitted[wanted == 1 ? 0 : i * (fitted.size() - 1) / (wanted - 1)]);
  }
  return chosen;
}

void AddDrawing(const ClipRecord& clip, bool fitted, ItemSpec& item) {
  item.inputs.push_back(InputFrom("evidence", clip.evidence));
  if (fitted) item.inputs.push_back(InputFrom("fit", clip.motion));
  item.inputs.insert(item.inputs.end(), clip.depth.begin(), clip.depth.end());
}

std::vector<ItemSpec> PictureItems(const std::vector<ClipRecord>& clips) {
  std::vector<ItemSpec> items;
  const auto drawn = ClipsToDraw(clips, 3);
  if (drawn.empty()) return items;
  const ClipRecord& clip = *drawn[drawn.size() / 2];
  for (const char* kind : {"clip", "overlay", "cloud"}) {
    if (clip.depth.empty() && std::string(kind) != "clip") continue;
    items.push_back({kind, {{"kind", kind}}, {}});
    AddDrawing(clip, true, items.back());
  }
  return items;
}

std::string ClipFileName(std::size_t index, const char* extension) {
  std::string number = std::to_string(index + 1);
  number.insert(0, number.size() < 3 ? 3 - number.size() : 0, '0');
  return "clip_" + number + "." + extension;
}

std::vector<ItemSpec> ClipPageItems(const std::vector<const ClipRecord*>& clips,
                                    const std::vector<ClipPageFiles>& files, const ReportOptions& options) {
  std::vector<ItemSpec> items;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    ClipPageOptions page;
    page.stills = options.filmstrip_frames;
    page.views = options.page_views;
    page.video = files[i].video;
    page.no_video = files[i].no_video;
    items.push_back({clips[i]->item, OptionsToJson(page), {}});
    AddDrawing(*clips[i], true, items.back());
  }
  return items;
}

std::vector<ItemSpec> ClipVideoItems(const std::vector<const ClipRecord*>& clips) {
  std::vector<ItemSpec> items;
  for (const ClipRecord* clip : clips) {
    items.push_back({clip->item, OptionsToJson(ClipVideoOptions()), {}});
    AddDrawing(*clip, true, items.back());
  }
  return items;
}

nlohmann::json RunSummary(const JobOptions& options, const std::vector<ClipRecord>& clips,
                          const std::map<std::string, ItemResult>& persons, const JobResult& result) {
  nlohmann::json run = {{"name", options.name},
                        {"description", options.description},
                        {"takes", options.takes},
                        {"created_by", CreatedBy()},
                        {"audit", result.audit},
                        {"metrics", result.metrics},
                        {"training", TrainingSummary(options.train, result)},
                        {"untrained", nlohmann::json::object()},
                        {"unevaluated", nullptr},
                        {"fit_error", result.fit_error},
                        {"pages", result.pages},
                        {"table_markdown", result.table},
                        {"findings", result.set_findings},
                        {"stages", nlohmann::json::array()},
                        {"clips", nlohmann::json::array()},
                        {"persons", nlohmann::json::object()}};
  for (const auto& [item, error] : result.untrained) {
    run["untrained"][item] = {{"code", Name(error.code)}, {"message", error.Message()}};
  }
  if (const auto& error = result.unevaluated) {
    run["unevaluated"] = {{"code", Name(error->code)}, {"message", error->Message()}};
  }
  for (const StageReport& stage : result.stages) run["stages"].push_back(StageSummary(stage));
  for (const ClipRecord& clip : clips) {
    if (!clip.folder()) run["clips"].push_back(ClipSummary(clip));
    if (clip.folder()) run["findings"].push_back(clip.evidence.outcome.findings.back());
  }
  for (const auto& [person, item] : persons) run["persons"][person] = item.outcome.summary;
  return run;
}

}  // namespace mocurate
