#include "job/job_items.h"

#include <algorithm>
#include <cmath>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/resources.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/store/store.h"
#include "ingest/checks/clip_checks.h"
#include "ingest/discover.h"
#include "ingest/formats/driver.h"
#include "job/main_job.h"

namespace mocurate {
namespace {

bool ItemHasArtifact(const ItemResult& item) { return !item.artifact.empty(); }

/// Whether a stage processed it and produced no artifact.
bool EndedHere(const ItemResult& item) { return !ItemHasArtifact(item) && !HasArtifact(item.outcome.kind); }

}  // namespace

const ItemResult* ClipRecord::ended() const {
  for (const ItemResult* stage : {&evidence, &motion, &canonical, &assembled}) {
    if (EndedHere(*stage)) return stage;
  }
  return nullptr;
}

std::string ClipRecord::ended_at() const {
  const ItemResult* stage = ended();
  if (stage == nullptr) return "";
  return stage == &evidence ? "ingest" : stage == &motion ? "fitting" : stage == &canonical ? "canon" : "assemble";
}

std::string ClipRecord::body(BodyOf body_of) const {
  const std::string recording = evidence.summary.value("recording", std::string());
  return body_of == BodyOf::kPerson || recording.empty() ? person() : person() + "/" + recording;
}

bool ClipRecord::folder() const {
  const std::vector<Finding>& findings = evidence.outcome.findings;
  return evidence.artifact.empty() && !findings.empty() && findings.back().code == kFolderNotRead;
}

std::vector<Finding> ClipRecord::findings() const {
  std::vector<Finding> all;
  for (const ItemResult* stage : {&evidence, &motion, &canonical, &assembled}) {
    if (stage == &motion && motion.sha256 == evidence.sha256) continue;
    all.insert(all.end(), stage->outcome.findings.begin(), stage->outcome.findings.end());
  }
  return all;
}

bool ClipRecord::has_error_finding() const {
  const std::vector<Finding> all = findings();
  return ended() == nullptr && std::any_of(all.begin(), all.end(),
                                           [](const Finding& finding) { return finding.severity == Severity::kError; });
}

bool ClipRecord::suspect() const {
  return ended() == nullptr && (has_error_finding() || motion.outcome.kind == OutcomeKind::kSuspect);
}

bool ClipRecord::replaces_rotations() const {
  return rotations && ItemHasArtifact(motion) && motion.summary.value("method", std::string("none")) != "none";
}

std::string ClipRecord::reason() const {
  const ItemResult* stage = ended();
  if (stage == nullptr) return "";
  const bool ruled = stage->outcome.kind == OutcomeKind::kExcluded && !stage->outcome.findings.empty();
  if (ruled) return stage->outcome.findings.back().code;
  for (const Finding& finding : stage->outcome.findings) {
    if (finding.action == FindingAction::kRefused) return finding.code;
  }
  if (stage == &evidence && stage->outcome.kind == OutcomeKind::kRefused) {
    return FaultCode(stage->outcome.error, format);
  }
  return std::string(Name(stage->outcome.error.code));
}

std::set<std::string> FindingCodes(const ClipRecord& clip) {
  std::set<std::string> codes;
  for (const Finding& finding : clip.findings()) {
    if (finding.severity != Severity::kInfo) codes.insert(finding.code);
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
    result.counts.suspect += clip.has_error_finding() ? 1 : 0;
    result.counts.replaces_rotations += clip.replaces_rotations() ? 1 : 0;
    ++(clip.kept()       ? result.counts.kept
       : clip.failed()   ? result.counts.failed
       : clip.excluded() ? result.counts.excluded
                         : result.counts.undecided);
  }
}

Error FirstReason(const std::vector<ClipRecord>& clips, ItemResult ClipRecord::*branch) {
  const ItemResult* first = nullptr;
  for (const ClipRecord& clip : clips) {
    const ItemResult* stage = clip.ended();
    if (branch == &ClipRecord::baseline && EndedHere(clip.baseline)) stage = &clip.baseline;
    if (stage != nullptr && !clip.folder() &&
        (first == nullptr || (IsFailure(stage->outcome.kind) && !IsFailure(first->outcome.kind))))
      first = stage;
  }
  if (first == nullptr) return {ErrorCode::kInconsistent, "no clip reached this stage", "", ""};
  const char* became = IsFailure(first->outcome.kind) ? "the first failed: " : "the first was excluded by a rule: ";
  return {first->outcome.error.code, became + first->outcome.error.Message(), "", ""};
}

Finding ComparisonDropped(const std::string& why) {
  return MakeFinding("comparison_dropped", Severity::kWarning, 0.0,
                     "the comparison with the raw tracks (trained_on: unfitted) was dropped: " + why,
                     FindingAction::kDropped);
}

void LogExcluded(const std::vector<ItemResult>& files) {
  const auto key = [](const ItemResult& file) {
    return std::pair(file.outcome.findings.back().code, file.outcome.kind);
  };
  std::map<std::pair<std::string, OutcomeKind>, long long> counts;
  for (const ItemResult& file : files) ++counts[key(file)];
  for (const ItemResult& file : files) {
    long long& count = counts[key(file)];
    if (count == 0) continue;  // reported with the first of its kind
    const Error& error = file.outcome.error;
    const bool named = error.where.empty() || error.where == file.item;
    std::string text =
        named ? Error{error.code, error.what, file.item, error.hint}.Message() : file.item + ": " + error.Message();
    const bool folder = file.outcome.findings.back().code == kFolderNotRead && !IsFailure(file.outcome.kind);
    if (count > 1 && !folder) {
      text = Counted(count, "file") + (IsFailure(file.outcome.kind) ? " refused (" : " excluded (") + key(file).first +
             "; curation_log.jsonl lists them), the first: " + text;
      count = 0;
    }
    Log(folder ? LogLevel::kInfo : LogLevel::kWarning, text);
  }
}

namespace {

/// Adds the hash of a clip's file, where the stage failed before it recorded it; for several files the hash of their
/// hashes, one per line, in the stage's order.
void AddHashOfSource(const ItemSpec& spec, ItemResult& failed) {
  if (failed.summary.contains("source_sha256")) return;
  std::string hashes;
  std::size_t files = 0;
  for (const StageInput& input : spec.inputs) {
    if (input.role != "source" && input.role != "depth") continue;
    const Expected<std::string> sha256 = Sha256OfFile(input.path);
    if (!sha256) return;
    hashes += (files++ > 0 ? "\n" : "") + *sha256;
  }
  if (files > 0) failed.summary.Set("source_sha256", files == 1 ? hashes : Sha256Hex(hashes));
}

/// Whether the files of clips contain rotations; a dataset or MotionSet is opened once to find out.
class RecordedRotations {
 public:
  bool operator()(const ItemSpec& spec) {
    const FormatDriver& facts = DriverOf(spec.options.value("format", std::string()));
    if (!facts.stored) return facts.rotations;
    const auto input = std::find_if(spec.inputs.begin(), spec.inputs.end(),
                                    [](const StageInput& candidate) { return candidate.role == "source"; });
    if (input == spec.inputs.end()) return false;
    const auto known = stores_.find(input->path);
    if (known != stores_.end()) return known->second;
    return stores_.emplace(input->path, HasStoredRotations(input->path)).first->second;
  }

 private:
  std::map<std::filesystem::path, bool> stores_;
};

}  // namespace

std::vector<ClipRecord> RecordsOf(const std::vector<ItemSpec>& specs, std::vector<ItemResult> ingested,
                                  std::vector<ItemResult> excluded) {
  std::vector<ClipRecord> clips;
  clips.reserve(ingested.size() + excluded.size());
  RecordedRotations has_rotations;
  for (std::size_t i = 0; i < ingested.size(); ++i) {
    ClipRecord clip;
    clip.item = ingested[i].item;
    clip.evidence = std::move(ingested[i]);
    clip.format = specs[i].options.value("format", std::string());
    clip.rotations = has_rotations(specs[i]);
    if (IsFailure(clip.evidence.outcome.kind)) AddHashOfSource(specs[i], clip.evidence);
    for (const StageInput& input : specs[i].inputs) {
      if (input.role == "depth") clip.depth.push_back(input);
    }
    clips.push_back(std::move(clip));
  }
  for (ItemResult& file : excluded) {
    ClipRecord clip;
    clip.item = file.item;
    clip.evidence = std::move(file);
    clips.push_back(std::move(clip));
  }
  return clips;
}

static void Warn(const char* code, const std::string& row, const std::string& text, nlohmann::json& metrics) {
  nlohmann::json& notes = metrics["notes"];  // before all others
  if (notes.is_null()) notes = nlohmann::json::array();
  notes.insert(notes.begin(), text + ".");
  metrics["warnings"].push_back({{"code", code}, {"row", row}, {"message", text}});
}

/// A recogniser of a low accuracy on real motions measures nothing.
static void NoteVoid(double least, nlohmann::json& metrics) {
  std::optional<double> worst;  // of the parts: the recogniser may have learned from the first
  std::string of;
  for (const nlohmann::json& row : metrics.value("rows", nlohmann::json::array())) {
    if (!row.value("real", false)) continue;
    const nlohmann::json accuracy =
        row.at("metrics").value("accuracy", nlohmann::json::object()).value("value", nlohmann::json());
    if (!accuracy.is_number() || (worst && accuracy.get<double>() >= *worst)) continue;
    worst = accuracy.get<double>();
    of = row.at("name").get<std::string>();
  }
  if (!worst || *worst >= least) return;
  Warn("void", of,
       "Void: the recogniser's accuracy on " + of + " is " + RoundedText(*worst, 2) + ", less than " +
           RoundedText(least, 2) + "; train it longer before a number of this table is read",
       metrics);
}

/// Features of a network that recognises less than a nearest neighbour of joint positions are no measure of motions.
static void NoteUnfitExtractor(const std::string& recogniser, nlohmann::json& metrics) {
  const nlohmann::json scored =
      metrics.value("recognisers", nlohmann::json::object()).value(recogniser, nlohmann::json());
  const nlohmann::json& nearest = metrics["nearest_neighbour"];
  if (!scored.is_object() || !scored.contains("mean") || !nearest.is_object() || nearest.value("count", 0) == 0) return;
  const double own = scored["mean"].get<double>(), other = nearest.at("accuracy").get<double>();
  const double variance = other * (1.0 - other) + own * (1.0 - own);
  const double by_chance = 1.645 * std::sqrt(variance / nearest.at("count").get<double>());  // one-sided, 5 %
  if (own >= other - by_chance) return;
  const std::string text = recogniser + " recognises " + RoundedText(own, 2) +
                           " of the test clips, a nearest neighbour of their joint positions " + RoundedText(other, 2) +
                           ": it is unfit as an extractor, train it longer before its FIDs are read";
  Warn("unfit_extractor", "", text, metrics);
}

nlohmann::json WithNotes(nlohmann::json metrics, const JobOptions& options, const JobResult& result) {
  for (const std::string& note : TrainingNotes(options.train, RecogniserOf(options))) metrics["notes"].push_back(note);
  for (const auto& [network, error] : result.untrained) {
    metrics["notes"].push_back(network + " was not trained: " + error.Message());
  }
  metrics["nearest_neighbour"] = result.audit.value("nearest_neighbour", nlohmann::json());
  NoteVoid(options.evaluate.least_real_accuracy, metrics);
  NoteUnfitExtractor(RecogniserOf(options), metrics);
  return metrics;
}

StageInput InputFrom(const char* role, const ItemResult& item) { return {role, item.item, item.artifact, item.sha256}; }

void LimitItems(const PipelineOptions& limits, RunnerOptions& runner) {
  runner.item_timeout_s = limits.item_timeout_s;
  if (limits.item_memory_bytes) runner.item_memory_bytes = static_cast<std::uint64_t>(*limits.item_memory_bytes);
}

constexpr std::size_t kMostSkeletonBytes = 16 << 20;  // as of every configuration

StageInput SkeletonInput(const std::string& name_or_path) {
  std::string content;
  if (const auto resource = FindResource("skeletons/" + name_or_path + ".yaml")) {
    content = std::string(*resource);
  } else if (const auto file = ReadSmallFile(name_or_path, kMostSkeletonBytes)) {
    content = *file;
  }
  return {kSkeletonRole, name_or_path, {}, Sha256Hex(content)};
}

std::optional<ItemSpec> DuplicatesItem(const std::vector<ClipRecord>& clips, const ItemOptions& options) {
  ItemSpec item{"duplicates", options, {}};
  for (const ClipRecord& clip : clips) {
    if (ItemHasArtifact(clip.evidence)) item.inputs.push_back(InputFrom("evidence", clip.evidence));
  }
  if (item.inputs.size() < 2) return std::nullopt;
  return item;
}

void NoteDuplicates(const ItemResult& found, std::vector<ClipRecord>& clips) {
  const nlohmann::json items = found.summary.value("items", nlohmann::json::array());
  const nlohmann::json dropped = found.summary.value("dropped", nlohmann::json::object());
  std::map<std::string, ClipRecord*> by_item;
  for (ClipRecord& clip : clips) by_item[clip.item] = &clip;
  for (std::size_t i = 0; i < items.size() && i < found.outcome.findings.size(); ++i) {
    const auto record = by_item.find(items[i].get<std::string>());
    if (record == by_item.end()) continue;
    Outcome& outcome = record->second->evidence.outcome;
    const Finding& finding = found.outcome.findings[i];
    outcome.findings.push_back(finding);
    if (finding.action != FindingAction::kDropped || !ItemHasArtifact(record->second->evidence)) continue;
    record->second->evidence.artifact.clear();
    outcome.kind = OutcomeKind::kExcluded;
    record->second->evidence.summary.Set("threshold", dropped.value(record->first, 0.0));
    outcome.error = Error{ErrorCode::kInconsistent, finding.message, record->first,
                          "ingest.source.checks." + finding.code + ".action: report keeps such clips"};
  }
}

std::vector<Finding> NoteExcludedFromSet(const ItemResult& assembled, std::vector<ClipRecord>& clips) {
  const nlohmann::json excluded = assembled.summary.value("excluded", nlohmann::json::object());
  std::vector<Finding> of_set = assembled.outcome.findings;
  std::vector<ItemResult> whole;
  for (ClipRecord& clip : clips) {
    const auto item = excluded.find(clip.item);
    if (item == excluded.end()) continue;
    Outcome& outcome = clip.assembled.outcome;
    for (const std::size_t i : item->at("findings").get<std::vector<std::size_t>>()) {
      outcome.findings.push_back(assembled.outcome.findings.at(i));
      of_set[i].code.clear();
    }
    if (!item->value("whole", false)) continue;
    clip.assembled.item = clip.item;
    outcome.kind = OutcomeKind::kExcluded;
    if (item->contains("threshold")) clip.assembled.summary.Set("threshold", item->at("threshold"));
    outcome.error =
        Error{ErrorCode::kInconsistent, outcome.findings.back().message, clip.item, item->value("hint", std::string())};
    whole.push_back(clip.assembled);
  }
  LogExcluded(whole);
  of_set.erase(
      std::remove_if(of_set.begin(), of_set.end(), [](const Finding& finding) { return finding.code.empty(); }),
      of_set.end());
  return of_set;
}

std::vector<ItemSpec> ProportionItems(const std::vector<ClipRecord>& clips, BodyOf body_of,
                                      const ItemOptions& options) {
  std::map<std::string, std::map<std::string, const ClipRecord*>> bodies;
  for (const ClipRecord& clip : clips) {
    if (ItemHasArtifact(clip.evidence)) bodies[clip.body(body_of)][clip.item] = &clip;
  }
  std::vector<ItemSpec> items;
  for (const auto& [body, members] : bodies) {
    std::vector<std::string> ids;
    for (const auto& [id, clip] : members) ids.push_back(id);
    ItemSpec item{body, options, {}};
    for (const std::string& id : ChooseProportionClips(ids)) {
      const ClipRecord& clip = *members.at(id);
      item.inputs.push_back(InputFrom("evidence", clip.evidence));
      item.inputs.insert(item.inputs.end(), clip.depth.begin(), clip.depth.end());
    }
    items.push_back(std::move(item));
  }
  return items;
}

FitItems FittingItems(std::vector<ClipRecord>& clips, BodyOf body_of, const std::map<std::string, ItemResult>& bodies,
                      const ItemOptions& options) {
  FitItems fits;
  for (ClipRecord& clip : clips) {
    if (!ItemHasArtifact(clip.evidence)) continue;
    const auto body = bodies.find(clip.body(body_of));
    if (body == bodies.end()) {
      clip.motion.outcome.kind = OutcomeKind::kRefused;
      clip.motion.outcome.error =
          Error{ErrorCode::kInconsistent, "the person is not declared", clip.item, "set ingest.source.person"};
    } else if (!ItemHasArtifact(body->second)) {
      clip.motion.outcome = body->second.outcome;
      clip.motion.summary = body->second.summary;
    } else {
      ItemSpec item{clip.item, options, {InputFrom("evidence", clip.evidence), InputFrom("proportions", body->second)}};
      item.inputs.insert(item.inputs.end(), clip.depth.begin(), clip.depth.end());
      fits.items.push_back(std::move(item));
      fits.clips.push_back(&clip);
    }
  }
  return fits;
}

FitItems GivenMotionItems(std::vector<ClipRecord>& clips, const ItemOptions& options) {
  FitItems given;
  for (ClipRecord& clip : clips) {
    if (!ItemHasArtifact(clip.evidence)) continue;
    given.items.push_back({clip.item, options, {InputFrom("evidence", clip.evidence)}});
    given.clips.push_back(&clip);
  }
  return given;
}

Expected<std::vector<StageInput>> TruthInputs(const std::filesystem::path& truth) {
  std::vector<StageInput> inputs;
  if (truth.empty()) return inputs;
  std::error_code unreadable;
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_regular_file(truth, unreadable)) files.push_back(truth);
  for (const auto& entry : std::filesystem::directory_iterator(truth, unreadable)) {
    if (entry.path().extension() == ".h5") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& file : files) inputs.push_back({"truth", file.filename().string(), file, ""});
  if (!inputs.empty()) return inputs;
  return Fail(ErrorCode::kNotFound, "no truth file (.h5) is here", DisplayPath(truth),
              "give the folder truth that `mocurate synthesize` writes beside a capture, or a file of it");
}

std::optional<ItemSpec> FitErrorItem(const std::vector<ClipRecord>& clips, const std::vector<StageInput>& truth) {
  ItemSpec item{"fit_error", nlohmann::json::object(), truth};
  for (const ClipRecord& clip : clips) {
    if (!ItemHasArtifact(clip.motion)) continue;
    item.inputs.push_back(InputFrom("fit", clip.motion));
    item.inputs.push_back(InputFrom("evidence", clip.evidence));
  }
  if (truth.empty() || item.inputs.size() == truth.size()) return std::nullopt;
  return item;
}

Status NoteFitErrors(const ItemResult& scored, std::vector<ClipRecord>& clips) {
  const auto errors = ReadJson(scored.artifact);
  if (!errors) return Forward(errors);
  if (!errors->is_object() || !errors->contains("per_clip")) return {};
  for (ClipRecord& clip : clips) {
    const auto error = errors->at("per_clip").find(clip.evidence.summary.value("clip", std::string()));
    if (error == errors->at("per_clip").end()) continue;
    const auto mm = error->find("joint_mm");
    if (mm != error->end() && mm->is_number()) clip.joint_error_mm = mm->get<double>();
  }
  return {};
}

}  // namespace mocurate
