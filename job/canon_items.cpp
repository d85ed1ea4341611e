#include "job/canon_items.h"

#include <algorithm>
#include <map>
#include <set>

#include "canon/recipes/spans_file.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "ingest/skipped_files.h"

namespace mocurate {
namespace {

constexpr std::size_t kMostOfFloor = 300;  // clips that a floor is estimated from, drawn by hash of their ids

/// Names by which a table of spans may refer to a clip: its item (source/person/recording), the recording, its id.
std::vector<std::string> NamesOf(const ClipRecord& clip) {
  const nlohmann::json summary = clip.evidence.summary;
  return {clip.item, summary.value("recording", clip.item.substr(clip.item.rfind('/') + 1)),
          summary.value("clip", clip.item)};
}

}  // namespace

std::vector<Finding> UnmatchedDropLabels(const CanonOptions& options, const std::vector<ItemResult>& items) {
  std::set<std::string> known;
  for (const ItemResult& item : items) {
    for (const auto& label : item.summary.value("labels", std::vector<std::string>())) known.insert(label);
  }
  std::vector<Finding> findings;
  if (known.empty()) return findings;
  for (const std::string& label : options.trim.drop_labels) {
    if (known.count(label) == 0) findings.push_back(UnmatchedName("canon.trim.drop_labels", "label", label, known));
  }
  return findings;
}

void LogSpansOutside(const std::vector<ItemResult>& items) {
  constexpr int kMostShown = 5;
  int outside = 0;
  for (const ItemResult& item : items) {
    for (const Finding& finding : item.outcome.findings) {
      if (finding.code != "span_outside" || ++outside > kMostShown) continue;
      LogWarning(DisplayPath(finding.clip) + ": " + finding.message);
    }
  }
  if (outside > kMostShown) {
    LogWarning(Counted(outside - kMostShown, "more span") + " not inside their clips; curation_log.jsonl lists them");
  }
}

Expected<std::vector<Finding>> UnmatchedSpans(const CanonOptions& options, const std::vector<ClipRecord>& clips) {
  std::vector<Finding> findings;
  const auto spans = ListedSpans(options.trim);
  if (!spans) return Forward(spans);
  std::vector<std::string> names;
  for (const ClipRecord& clip : clips) {
    const std::vector<std::string> own = NamesOf(clip);
    names.insert(names.end(), own.begin(), own.end());
  }
  const std::set<std::string> known(names.begin(), names.end());
  const ListedSpan* first = nullptr;
  long long unmatched = 0;
  for (const ListedSpan& span : *spans) {
    if (known.count(span.clip) != 0) continue;
    if (first == nullptr) first = &span;
    ++unmatched;
  }
  if (first == nullptr) return findings;
  const auto near = Nearest(first->clip, names);
  findings.push_back(MakeFinding(
      "span_without_clip", Severity::kWarning, static_cast<double>(unmatched),
      first->place + ": no clip has the name '" + first->clip + "'" +
          (unmatched > 1 ? ", and " + Counted(unmatched - 1, "other span") + " of the table match no clip" : "") +
          (near ? "; did you mean '" + *near + "'?" : "; clips are called source/person/recording")));
  return findings;
}

std::optional<StageInput> SpansInput(const TrimOptions& options) {
  if (!options.spans.empty()) return StageInput{kSpansRole, DisplayPath(options.spans), options.spans, ""};
  const auto table = BuiltInSpans(options.spans_of);
  if (!table) return std::nullopt;
  return StageInput{kSpansRole, options.spans_of, "", Sha256Hex(std::string(*table))};
}

std::string CanonText(const CanonOptions& options) {
  const nlohmann::json all = OptionsToJson(options);
  const nlohmann::json& trim = all.at("trim");
  const nlohmann::json& level = all.at("level");
  const nlohmann::json& facing = all.at("facing");
  const auto text = [](const nlohmann::json& group, const char* option) {
    return group.at(option).is_string() ? group.at(option).get<std::string>() : group.at(option).dump();
  };
  std::string line = "canon: rate " + (options.rate.empty() ? "as recorded" : options.rate) + ", trim " +
                     text(trim, "rule") + ", level " + text(level, "rule");
  if (options.level.rule != FloorRule::kNone) line += " of " + text(level, "of");
  line += ", facing " + text(facing, "rule");
  if (options.facing.rule == FacingRule::kNone) return line;
  line += ", anchor " + text(facing, "anchor");
  if (options.facing.anchor == Anchor::kFrame) line += " " + std::to_string(options.facing.anchor_frame);
  return line + ", height " + text(facing, "height");
}

Status CheckCanon(const CanonOptions& options) {
  const TrimOptions& trim = options.trim;
  const auto readable = [](const Expected<std::vector<ListedSpan>>& spans, const char* option) -> Status {
    if (spans) return {};
    return Fail(ErrorCode::kConfig, spans.error().what, spans.error().where,
                spans.error().hint.empty()
                    ? std::string(option) + " names a table with columns clip,begin_s,end_s,label"
                    : spans.error().hint);
  };
  if (!trim.spans.empty() || !trim.spans_of.empty()) {
    if (Status read = readable(ListedSpans(trim), "canon.trim.spans"); !read) return read;
    if (trim.rule != TrimRule::kAnnotated && trim.rule != TrimRule::kTriples) {
      return Fail(ErrorCode::kConfig, "only the rules annotated and triples read listed spans", "canon.trim.spans",
                  "set canon.trim.rule: annotated");
    }
  }
  if (trim.rule == TrimRule::kByExample) {
    if (trim.by_example.examples.empty()) {
      return Fail(ErrorCode::kConfig, "no table of marked spans is given", "canon.trim.by_example.examples",
                  "name a table with columns clip,begin_s,end_s,label; `mocurate review --annotate` writes one");
    }
    if (Status read = readable(ReadSpans(trim.by_example.examples), "canon.trim.by_example.examples"); !read)
      return read;
  }
  if (trim.rule == TrimRule::kTriples && (!trim.drop_labels.empty() || trim.class_from == ClassFrom::kCategory)) {
    return Fail(ErrorCode::kConfig, "rule triples does not read drop_labels and class_from: category", "canon.trim",
                "remove them; assemble.classes selects the last actions");
  }
  if (trim.as_segments && trim.rule == TrimRule::kTriples) {
    return Fail(ErrorCode::kConfig, "as_segments does not apply to samples of two actions", "canon.trim.as_segments",
                "remove it, or set canon.trim.rule: annotated");
  }
  const FacingOptions& facing = options.facing;
  if (facing.anchor_frame != 0 && facing.anchor != Anchor::kFrame) {
    return Fail(ErrorCode::kConfig, "anchor_frame is only read with anchor: frame", "canon.facing.anchor_frame",
                "set canon.facing.anchor: frame");
  }
  if (facing.rule == FacingRule::kGiven && facing.given.empty()) {
    return Fail(ErrorCode::kConfig, "no rotation is given", "canon.facing.given",
                "add {rotation: [9 numbers]}, for all or by persons and views");
  }
  return {};
}

Expected<std::vector<StageInput>> ExampleInputs(const CanonOptions& options, const std::vector<ClipRecord>& clips,
                                                const std::map<std::string, ItemResult>& floors) {
  const std::filesystem::path& table = options.trim.by_example.examples;
  const LevelOptions& level = options.level;
  const auto spans = ReadSpans(table);
  if (!spans) return Forward(spans);
  std::map<std::string, const ListedSpan*> wanted;
  for (const ListedSpan& span : *spans) wanted.emplace(span.clip, &span);
  std::vector<StageInput> inputs = {{kExamplesRole, DisplayPath(table), table, ""}};
  std::vector<std::string> names;
  for (const ClipRecord& clip : clips) {
    const nlohmann::json summary = clip.evidence.summary;
    const double rate = summary.value("rate_hz", 0.0), first = summary.value("first_frame", 0.0);
    const ListedSpan* marked = nullptr;
    for (const std::string& name : NamesOf(clip)) {
      names.push_back(name);
      wanted.erase(name);
      for (const ListedSpan& span : *spans) {
        if (span.clip != name) continue;
        marked = &span;
        const double scale = span.in_frames ? 1.0 : rate;
        const double begin = span.begin * scale - first, frames = summary.value("frames", 0.0);
        if (frames == 0.0 || (begin < frames && (span.end - span.begin) * scale >= 2.0)) continue;
        return Fail(ErrorCode::kConfig,
                    begin >= frames ? "the span begins at frame " + RoundedText(begin, 9) + " of " +
                                          RoundedText(frames, 9) + " of the clip"
                                    : "the span is shorter than two frames of " + RoundedText(rate) + " Hz",
                    span.place, "mark spans of about a second, inside the recording");
      }
    }
    if (marked == nullptr) continue;
    if (clip.motion.artifact.empty()) {
      const ItemResult* ended = clip.ended();
      return Fail(ErrorCode::kConfig,
                  "the clip with marked spans has no motion" +
                      (ended == nullptr ? std::string() : ": " + ended->outcome.error.what),
                  marked->place, "mark spans of another clip");
    }
    inputs.push_back(InputFrom(kExampleRole, clip.motion));
    const auto floor = floors.find(FloorGroup(clip, level.of));
    if (floor != floors.end() && !floor->second.artifact.empty()) {
      inputs.push_back({kExampleFloorRole, clip.item, floor->second.artifact, floor->second.sha256});
    }
  }
  if (!wanted.empty() || inputs.size() == 1) {
    const std::string missing = wanted.empty() ? std::string() : wanted.begin()->first;
    return Fail(ErrorCode::kConfig,
                missing.empty() ? "no clip with marked spans has a motion" : "no clip has the name '" + missing + "'",
                wanted.empty() ? DisplayPath(table) : wanted.begin()->second->place,
                DidYouMean(missing, names, "clips are called source/person/recording"));
  }
  return inputs;
}

std::string FloorGroup(const ClipRecord& clip, LevelOf of) {
  const auto named = [&](const char* field) { return clip.evidence.summary.value(field, std::string()); };
  const std::string person = named("person");
  switch (of) {
    case LevelOf::kSet:
      return "set";
    case LevelOf::kSession:
      return "session " + person + "/" + named("session");
    case LevelOf::kView:
      return "view " + named("session") + "/" + named("view");
    case LevelOf::kPerson:
      return "person " + person;
    case LevelOf::kClip:
      return clip.item;
  }
  return "";
}

std::vector<ItemSpec> LevelItems(const std::vector<ClipRecord>& clips, const LevelOptions& options) {
  std::map<std::string, std::map<std::string, const ClipRecord*>> groups;  // by hash of the name: a draw
  for (const ClipRecord& clip : clips) {
    if (!clip.motion.artifact.empty()) groups[FloorGroup(clip, options.of)][Sha256Hex(clip.item)] = &clip;
  }
  std::vector<ItemSpec> items;
  for (const auto& [group, members] : groups) {
    ItemSpec item{group, OptionsToJson(options), {}};
    for (const auto& [hash, clip] : members) {
      if (item.inputs.size() == kMostOfFloor) break;
      item.inputs.push_back(InputFrom("motion", clip->motion));
    }
    items.push_back(std::move(item));
  }
  return items;
}

}  // namespace mocurate
