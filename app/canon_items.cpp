#include "app/canon_items.h"

#include "canon/recipes/spans_file.h"
#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/text.h"
#include "ingest/files_check.h"

namespace mocurate {

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

Expected<std::vector<Finding>> UnmatchedSpans(const CanonOptions& options, const std::vector<ItemResult>& items) {
  std::vector<Finding> findings;
  if (options.trim.spans.empty()) return findings;
  const auto spans = ReadSpans(options.trim.spans);
  if (!spans) return Forward(spans);
  std::set<int> taken;
  for (const ItemResult& item : items) {
    for (const int line : item.outcome.summary.value("spans", std::vector<int>())) taken.insert(line);
  }
  std::vector<std::string> names;
  for (const ItemResult& item : items) names.push_back(item.item);
  const ListedSpan* first = nullptr;
  long long unmatched = 0;
  for (const ListedSpan& span : *spans) {
    if (taken.count(span.line) != 0) continue;
    if (first == nullptr) first = &span;
    ++unmatched;
  }
  if (first == nullptr) return findings;
  const auto near = Nearest(first->clip, names);
  Finding finding;
  finding.code = "span_without_clip";
  finding.value = static_cast<double>(unmatched);
  finding.message = Counted(unmatched, "span") + " of " + DisplayPath(options.trim.spans) +
                    " name no clip, the first on line " + std::to_string(first->line) + ": '" + first->clip + "'" +
                    (near ? "; did you mean '" + *near + "'?" : "; clips are called source/person/recording");
  finding.action = "flagged";
  findings.push_back(finding);
  return findings;
}

StageInput SpansInput(const std::filesystem::path& file_or_name) {
  const auto built_in = BuiltInSpans(file_or_name);
  return {kSpansRole, DisplayPath(file_or_name), file_or_name,
          built_in ? Sha256Hex(std::string(*built_in)) : std::string()};
}

Expected<std::vector<StageInput>> ExampleInputs(const std::filesystem::path& table,
                                                const std::vector<ClipRecord>& clips, ItemResult ClipRecord::*from) {
  const char* option = "canon.trim.by_example.examples";
  if (table.empty()) {
    return Fail(ErrorCode::kConfig, "no spans are marked", option,
                "name a table clip,begin_s,end_s,label; mocurate review --annotate writes one");
  }
  const auto spans = ReadSpans(table);
  if (!spans) return Forward(spans);
  std::set<std::string> wanted;
  for (const ListedSpan& span : *spans) wanted.insert(span.clip);
  std::vector<StageInput> inputs = {{kExamplesRole, DisplayPath(table), table, ""}};
  std::vector<std::string> names;
  for (const ClipRecord& clip : clips) {
    const nlohmann::json& summary = clip.evidence.outcome.summary;
    names.push_back(clip.item);
    const std::string known[] = {clip.item, summary.value("recording", std::string()),
                                 summary.value("clip", std::string())};
    bool named = false;
    for (const std::string& name : known) named = wanted.erase(name) > 0 || named;
    if (named && !(clip.*from).artifact.empty()) inputs.push_back(InputFrom(kExampleRole, clip.*from));
  }
  if (!wanted.empty() || inputs.size() == 1) {
    const std::string missing = wanted.empty() ? "" : *wanted.begin();
    const auto near = Nearest(missing, names);
    return Fail(ErrorCode::kConfig,
                missing.empty() ? "no clip with marked spans has a motion" : "no clip is called '" + missing + "'",
                DisplayPath(table),
                near ? "did you mean '" + *near + "'?" : "clips are called source/person/recording");
  }
  return inputs;
}

std::string FloorGroup(const ClipRecord& clip, LevelOf of) {
  const auto named = [&](const char* field) { return clip.evidence.outcome.summary.value(field, std::string()); };
  switch (of) {
    case LevelOf::kSet:
      return "set";
    case LevelOf::kSession:
      return "session " + named("session");
    case LevelOf::kView:
      return "view " + named("view");
    case LevelOf::kPerson:
      return "person " + named("person");
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
      if (static_cast<std::int64_t>(item.inputs.size()) == options.most_clips) break;
      item.inputs.push_back(InputFrom("motion", clip->motion));
    }
    items.push_back(std::move(item));
  }
  return items;
}

}  // namespace mocurate
