// Inspections as JSON and as text.

#include "ingest/inspect/inspection.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "ingest/inspect/file_names.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;

/// Texts of files may be of any encoding.
std::string Dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

constexpr std::size_t kMostPlaces = 3;  // named per code of findings or format of companions

/// Calls `visit(name, field)` for what is reported of a clip, in the order of the text.
template <class Visit>
void ForEachField(const InspectedClip& clip, const Visit& visit) {
  if (!clip.item.empty()) {
    visit("person", clip.person);
    visit("label", clip.label);
  }
  visit("frames", clip.frames);
  visit("rate_hz", clip.rate_hz);
  visit("joints", clip.joints);
  visit("people", clip.people);
  ForEachSharedText([&](const char* name, auto of_clip, auto) { visit(name, clip.*of_clip); });
  visit("missing_share", clip.missing_share);
}

template <class Visit>
void ForEachField(const InspectedGroup& group, const Visit& visit) {
  visit("rate_hz", group.rate_hz);
  ForEachSharedText([&](const char* name, auto, auto of_group) { visit(name, group.*of_group); });
}

template <class T>
Json ValueJson(const T& value) {
  return value;
}

Json ValueJson(const Vector3d& value) { return {value.x(), value.y(), value.z()}; }

/// Names of the joints are added by the caller.
Json ValueJson(const std::vector<std::optional<Vector3d>>& points) {
  Json list = Json::array();
  for (const std::optional<Vector3d>& point : points) {
    list.push_back({{"joint", nullptr}, {"position", point ? ValueJson(*point) : Json()}});
  }
  return list;
}

template <class T>
Json ToJson(const std::optional<T>& value) {
  return value ? ValueJson(*value) : Json();
}

template <class T>
Json ToJson(const Estimate<T>& estimate) {
  return {{"value", ToJson(estimate.value)}, {"confidence", estimate.confidence}, {"evidence", estimate.evidence}};
}

template <class T>
Json ToJson(const Reported<T>& reported) {
  Json json = ToJson<T>(static_cast<const Estimate<T>&>(reported));
  json["from"] = Name(reported.from);
  if (reported.measured) json["measured"] = ToJson(*reported.measured);
  return json;
}

template <class T>
Json ToJson(const Pooled<T>& pooled) {
  return {{"value", ToJson(pooled.value)}, {"from", Name(pooled.from)}, {"share", pooled.share}};
}

Json FactsJson(const std::vector<std::pair<std::string, std::string>>& texts,
               const std::vector<std::pair<std::string, double>>& numbers = {}) {
  Json facts = Json::object();
  for (const auto& [key, text] : texts) facts[key] = text;
  for (const auto& [key, number] : numbers) facts[key] = number;
  return facts;
}

Json ToJson(const InspectedClip& clip) {
  Json json = {{"id", clip.id}, {"file", clip.file}, {"format", clip.format}};
  ForEachField(clip, [&](const char* name, const auto& field) { json[name] = ToJson(field); });
  if (clip.rate_range) {
    Json& rate = clip.rate_hz.measured ? json["rate_hz"]["measured"] : json["rate_hz"];
    rate["range"] = {ToJson(clip.rate_range->lowest), ToJson(clip.rate_range->highest)};
  }
  json["people_per_frame"] = json["people"];
  json["people_per_frame"]["value"] = {{"min", clip.fewest_people}, {"max", json["people"]["value"]}};
  json["first_frame"] = ToJson(clip.first_frame);
  Json& points = json["first_frame"]["value"];
  for (std::size_t j = 0; j < points.size() && !clip.joint_names.empty(); ++j) points[j]["joint"] = clip.joint_names[j];
  if (!clip.facts.empty()) json["facts"] = FactsJson(clip.facts);
  if (!clip.item.empty()) json["item"] = clip.item;
  return json;
}

Json ToJson(const InspectedGroup& group) {
  Json json = {{"folder", group.folder},
               {"format", group.format},
               {"joints", ToJson(group.joints)},
               {"clips", group.clips},
               {"frames", {{"sum", group.frames}, {"min", group.fewest_frames}, {"max", group.most_frames}}}};
  ForEachField(group, [&](const char* name, const auto& field) { json[name] = ToJson(field); });
  return json;
}

Json ToJson(const InspectedCamera& camera) {
  return {{"id", camera.id},
          {"file", camera.file},
          {"format", camera.format},
          {"world", camera.world},
          {"kind", camera.kind},
          {"units", ToJson(camera.units)},
          {"reading", ToJson(camera.reading)},
          {"up", ToJson(camera.up)},
          {"image_size", ToJson(camera.image_size)},
          {"centre_m", ToJson(camera.centre_m)}};
}

Json ToJson(const InspectedCloud& cloud) {
  return {{"id", cloud.file},
          {"file", cloud.file},
          {"format", cloud.format},
          {"points", cloud.points},
          {"triangles", cloud.triangles},
          {"extent", ToJson(cloud.extent)},
          {"units", ToJson(cloud.units)}};
}

Json ToJson(const RawCompanion& companion) {
  return {
      {"file", companion.file}, {"format", companion.format}, {"facts", FactsJson(companion.texts, companion.numbers)}};
}

Json ToJson(const Finding& finding) {
  return {{"code", finding.code},
          {"severity", Name(finding.severity)},
          {"where", finding.clip},
          {"value", finding.value},
          {"message", finding.message}};
}

template <class T>
Json ToJson(const std::vector<T>& entries) {
  Json list = Json::array();
  for (const T& entry : entries) list.push_back(ToJson(entry));
  return list;
}

template <class T>
std::string ValueText(const std::optional<T>& value) {
  if (!value) return "?";
  if constexpr (std::is_same_v<T, std::string>) return *value;
  return Dumped(ValueJson(*value));
}

std::string WholePercent(double share) { return std::to_string(static_cast<int>(share * 100.0 + 0.5)) + " %"; }

std::string NamedLine(const std::string& name, const std::string& text) {
  return "  " + name + std::string(name.size() < 12 ? 12 - name.size() : 1, ' ') + text + "\n";
}

template <class T>
std::string SureText(const Estimate<T>& estimate) {
  return WholePercent(estimate.confidence) + " confidence: " + estimate.evidence;
}

template <class T>
std::string FieldText(const char* name, const Reported<T>& field) {
  std::string text = ValueText(field.value) + "  ";
  text += field.from == Provenance::kMeasured ? "measured, " + SureText(field) : field.evidence;
  if (field.measured) {
    text += "; measured " + (field.measured->value ? ValueText(field.measured->value) + ", " + SureText(*field.measured)
                                                   : field.measured->evidence);
  }
  return NamedLine(name, text);
}

std::string ClipText(const InspectedClip& clip) {
  std::string text = clip.id + ": " + clip.format + "\n";
  ForEachField(clip, [&](const char* name, const auto& field) { text += FieldText(name, field); });
  if (!clip.facts.empty()) text += NamedLine("facts", Dumped(FactsJson(clip.facts)));
  return text;
}

template <class T>
std::string FieldText(const char* name, const Pooled<T>& pooled) {
  std::string text = ValueText(pooled.value);
  // A declaration is one for all clips: what they show is reported by the findings.
  const bool all_say_so = pooled.from == Provenance::kDeclared && pooled.share >= 1.0;
  if (pooled.value) text += "  " + std::string(Name(pooled.from));
  if (pooled.value && !all_say_so) text += ", " + WholePercent(pooled.share) + " agree";
  return NamedLine(name, text);
}

/// The first ids of the group's clips, as --clip takes them.
std::string IdsOf(const InspectedGroup& group, const std::vector<InspectedClip>& clips) {
  constexpr std::size_t kMostIds = 8;
  std::string text;
  std::size_t count = 0;
  for (const InspectedClip& clip : clips) {
    const bool own =
        FolderOf(clip.file) == group.folder && clip.format == group.format && clip.joints.value == group.joints;
    if (own && count++ < kMostIds) text += (text.empty() ? "" : ", ") + clip.id;
  }
  return text + (count > kMostIds ? " and " + std::to_string(count - kMostIds) + " more (--json lists them)" : "");
}

std::string GroupText(const InspectedGroup& group, const std::vector<InspectedClip>& clips) {
  std::string text = (group.folder.empty() ? "" : group.folder + "/: ") +
                     Counted(static_cast<long long>(group.clips), "clip") + ", " + group.format + "\n" +
                     NamedLine("ids", IdsOf(group, clips)) +
                     NamedLine("frames", std::to_string(group.frames) + " (" + std::to_string(group.fewest_frames) +
                                             " to " + std::to_string(group.most_frames) + " a clip)") +
                     NamedLine("joints", ValueText(group.joints));
  ForEachField(group, [&](const char* name, const auto& field) { text += FieldText(name, field); });
  return text;
}

/// The first entries of a list, and how many more there are.
std::string FirstLines(const std::vector<std::string>& lines) {
  std::string text;
  for (std::size_t i = 0; i < std::min(lines.size(), kMostPlaces); ++i) text += "  " + lines[i] + "\n";
  return text + (lines.size() > kMostPlaces ? "  and " + std::to_string(lines.size() - kMostPlaces) + " more\n" : "");
}

/// Entries that say the same, with their count: cameras of one calibration, clouds, what stands beside.
std::string SceneText(const Inspection& inspection) {
  std::map<std::string, int> cameras;
  for (const InspectedCamera& camera : inspection.cameras) {
    ++cameras[camera.file + ": " + camera.format + "\n" + FieldText("units", camera.units) +
              FieldText("reading", camera.reading) + FieldText("up", camera.up) +
              NamedLine("image_size", ValueText(camera.image_size.value))];
  }
  std::string text;
  for (const auto& [lines, count] : cameras) {
    text += "\n" + std::to_string(count) + (count == 1 ? " camera of " : " cameras of ") + lines;
  }
  std::map<std::string, std::size_t> clouds;
  for (const InspectedCloud& cloud : inspection.clouds) {
    if (clouds[FolderOf(cloud.file)]++ >= kMostPlaces) continue;
    text += "\n" + cloud.file + ": " + cloud.format + ", " + Counted(static_cast<long long>(cloud.points), "point") +
            ", " + Counted(static_cast<long long>(cloud.triangles), "triangle") + "\n" +
            FieldText("extent", cloud.extent) + FieldText("units", cloud.units);
  }
  for (const auto& [folder, count] : clouds) {
    if (count > kMostPlaces)
      text += "\n" + Counted(static_cast<long long>(count), "cloud") + (folder.empty() ? "" : " in " + folder + "/") +
              " in all\n";
  }
  std::map<std::string, std::vector<std::string>> companions;
  for (const RawCompanion& companion : inspection.companions) {
    companions[companion.format].push_back(companion.file + " " +
                                           Dumped(FactsJson(companion.texts, companion.numbers)));
  }
  for (const auto& [format, lines] : companions) {
    text += "\n" + std::to_string(lines.size()) + " " + format + "\n" + FirstLines(lines);
  }
  return text;
}

std::string FindingsText(const std::vector<Finding>& findings) {
  std::map<std::string, std::vector<std::string>> by_code;
  for (const Finding& finding : findings) {
    const bool names = finding.message.rfind(finding.clip + ":", 0) == 0;  // a place in the file has its name too
    by_code[std::string(Name(finding.severity)) + " " + finding.code].push_back((names ? "" : finding.clip + ": ") +
                                                                                finding.message);
  }
  std::string text;
  for (const auto& [code, lines] : by_code) {
    text += code + (lines.size() > 1 ? " (" + std::to_string(lines.size()) + " times)" : "") + "\n" + FirstLines(lines);
  }
  return text;
}

}  // namespace

std::string_view Name(Provenance provenance) {
  if (provenance == Provenance::kUnknown) return "unknown";
  return provenance == Provenance::kDeclared ? "declared" : "measured";
}

std::string InspectedClip::Fact(std::string_view key) const {
  const auto fact =
      std::find_if(facts.rbegin(), facts.rend(), [&](const auto& key_and_text) { return key_and_text.first == key; });
  return fact == facts.rend() ? "" : fact->second;
}

void to_json(Json& json, const Inspection& inspection) {
  json = {{"path", inspection.path},
          {"format", inspection.format},
          {"clips", ToJson(inspection.clips)},
          {"groups", ToJson(inspection.groups)},
          {"cameras", ToJson(inspection.cameras)},
          {"clouds", ToJson(inspection.clouds)},
          {"companions", ToJson(inspection.companions)},
          {"findings", ToJson(inspection.findings)}};
}

std::string InspectionText(const Inspection& inspection) {
  std::string text = inspection.path + ": " + inspection.format + ", " +
                     Counted(static_cast<long long>(inspection.clips.size()), "clip") + "\n";
  if (inspection.clips.size() <= 2) {
    for (const InspectedClip& clip : inspection.clips) text += "\n" + ClipText(clip);
  } else {
    for (const InspectedGroup& group : inspection.groups) text += "\n" + GroupText(group, inspection.clips);
  }
  text += SceneText(inspection);
  const std::string findings = FindingsText(inspection.findings);
  return text + (findings.empty() ? "" : "\n" + findings);
}

Finding FindingAt(std::string place, std::string code, Severity severity, double value, std::string message) {
  Finding finding = MakeFinding(std::move(code), severity, value, std::move(message));
  finding.clip = std::move(place);
  return finding;
}

Finding FindingAt(std::string place, const Finding& finding) {
  return FindingAt(std::move(place), finding.code, finding.severity, finding.value, finding.message);
}

Finding Rounded(Finding finding) {
  finding.value = FourDecimals(finding.value);
  return finding;
}

bool HasFinding(const std::vector<Finding>& findings, std::string_view code) {
  return std::any_of(findings.begin(), findings.end(), [&](const Finding& finding) { return finding.code == code; });
}

}  // namespace mocurate
