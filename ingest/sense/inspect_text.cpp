#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/text.h"
#include "ingest/sense/file_names.h"
#include "ingest/sense/inspect.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostPlaces = 3;  // named per kind of finding or companion

std::string Text(const Json& value) {
  if (value.is_null()) return "?";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string WholePercent(const Json& share) {
  return std::to_string(static_cast<int>(share.get<double>() * 100.0 + 0.5)) + " %";
}

std::string NamedLine(const std::string& name, const std::string& text) {
  return "  " + name + std::string(name.size() < 12 ? 12 - name.size() : 1, ' ') + text + "\n";
}

std::string FieldText(const char* name, const Json& field) {
  std::string text = Text(field.at("value"));
  const std::string from = field.at("from");
  if (from == "measured")
    text += "  measured, " + WholePercent(field.at("confidence")) + " sure: " + field.at("evidence").get<std::string>();
  if (from == "declared") text += "  " + field.at("evidence").get<std::string>();
  if (from == "unknown") text += "  " + field.at("evidence").get<std::string>();
  if (field.contains("measured")) {
    const Json& measured = field.at("measured");
    text += "; measured " + (measured.at("value").is_null() ? "" : Text(measured.at("value")) + ", ") +
            WholePercent(measured.at("confidence")) + " sure: " + measured.at("evidence").get<std::string>();
  }
  return NamedLine(name, text);
}

std::string ClipText(const Json& clip) {
  std::string text = clip.at("id").get<std::string>() + ": " + clip.at("format").get<std::string>() + "\n";
  for (const char* name : {"person", "label"}) {
    if (clip.contains(name)) text += FieldText(name, clip.at(name));
  }
  for (const char* name : {"frames", "rate_hz", "joints", "people", "skeleton", "units", "up", "handedness", "facing",
                           "axes", "missing_share"}) {
    text += FieldText(name, clip.at(name));
  }
  if (clip.contains("facts")) text += NamedLine("facts", clip.at("facts").dump());
  return text;
}

/// A declaration is one for all clips: what they show is told by the findings.
std::string Agreement(const Json& field) {
  const bool all_say_so = field.at("from") == "declared" && field.at("share").get<double>() >= 1.0;
  return all_say_so ? "" : ", " + WholePercent(field.at("share")) + " agree";
}

std::string GroupText(const Json& group) {
  const Json& frames = group.at("frames");
  std::string text =
      (group.at("folder").get<std::string>().empty() ? "" : group.at("folder").get<std::string>() + "/: ") +
      Counted(group.at("clips").get<long long>(), "clip") + ", " + group.at("format").get<std::string>() + "\n";
  text += NamedLine(
      "frames", Text(frames.at("sum")) + " (" + Text(frames.at("min")) + " to " + Text(frames.at("max")) + " a clip)");
  text += NamedLine("joints", Text(group.at("joints")));
  for (const char* name : {"rate_hz", "skeleton", "units", "up", "handedness", "facing", "axes"}) {
    const Json& field = group.at(name);
    std::string value = Text(field.at("value"));
    if (!field.at("value").is_null()) value += "  " + field.at("from").get<std::string>() + Agreement(field);
    text += NamedLine(name, value);
  }
  return text;
}

/// Entries that say the same, with their count: cameras of one calibration, clouds, what stands beside.
std::string SceneText(const Json& inspection) {
  std::map<std::string, int> cameras;
  for (const Json& camera : inspection.at("cameras")) {
    ++cameras[camera.at("file").get<std::string>() + ": " + camera.at("format").get<std::string>() + "\n" +
              FieldText("units", camera.at("units")) + FieldText("reading", camera.at("reading")) +
              FieldText("up", camera.at("up")) + NamedLine("image_size", Text(camera.at("image_size").at("value")))];
  }
  std::string text;
  for (const auto& [lines, count] : cameras) {
    text += "\n" + std::to_string(count) + (count == 1 ? " camera of " : " cameras of ") + lines;
  }
  std::map<std::string, std::size_t> clouds;
  for (const Json& cloud : inspection.at("clouds")) {
    const std::string folder = FolderOf(cloud.at("file"));
    if (clouds[folder]++ >= kMostPlaces) continue;
    text += "\n" + cloud.at("id").get<std::string>() + ": " + cloud.at("format").get<std::string>() + ", " +
            Counted(cloud.at("points").get<long long>(), "point") + ", " +
            Counted(cloud.at("triangles").get<long long>(), "triangle") + "\n" +
            FieldText("extent", cloud.at("extent")) + FieldText("units", cloud.at("units"));
  }
  for (const auto& [folder, count] : clouds) {
    if (count > kMostPlaces)
      text += "\n" + Counted(static_cast<long long>(count), "cloud") + (folder.empty() ? "" : " in " + folder + "/") +
              " in all\n";
  }
  std::map<std::string, std::vector<const Json*>> companions;
  for (const Json& companion : inspection.at("companions")) {
    companions[companion.at("format").get<std::string>()].push_back(&companion);
  }
  for (const auto& [format, members] : companions) {
    text += "\n" + std::to_string(members.size()) + " " + format + "\n";
    for (std::size_t i = 0; i < members.size() && i < kMostPlaces; ++i) {
      text += "  " + members[i]->at("file").get<std::string>() + " " + members[i]->at("facts").dump() + "\n";
    }
    if (members.size() > kMostPlaces) text += "  and " + std::to_string(members.size() - kMostPlaces) + " more\n";
  }
  return text;
}

std::string FindingsText(const Json& findings) {
  std::map<std::string, std::vector<const Json*>> by_code;
  for (const Json& finding : findings) {
    by_code[finding.at("severity").get<std::string>() + " " + finding.at("code").get<std::string>()].push_back(
        &finding);
  }
  std::string text;
  for (const auto& [code, members] : by_code) {
    text += code + (members.size() > 1 ? " (" + std::to_string(members.size()) + " times)" : "") + "\n";
    for (std::size_t i = 0; i < members.size() && i < kMostPlaces; ++i) {
      const auto where = members[i]->at("where").get<std::string>();
      const auto message = members[i]->at("message").get<std::string>();
      const bool names = message.rfind(where + ":", 0) == 0;  // a place in the file is told by its name too
      text += "  " + (names ? "" : where + ": ") + message + "\n";
    }
    if (members.size() > kMostPlaces) text += "  and " + std::to_string(members.size() - kMostPlaces) + " more\n";
  }
  return text;
}

}  // namespace

std::string InspectionText(const Json& inspection) {
  const Json& clips = inspection.at("clips");
  std::string text = inspection.at("path").get<std::string>() + ": " + inspection.at("format").get<std::string>() +
                     ", " + Counted(static_cast<long long>(clips.size()), "clip") + "\n";
  if (clips.size() <= 2) {
    for (const Json& clip : clips) text += "\n" + ClipText(clip);
  } else {
    for (const Json& group : inspection.at("groups")) text += "\n" + GroupText(group);
  }
  text += SceneText(inspection);
  const std::string findings = FindingsText(inspection.at("findings"));
  return text + (findings.empty() ? "" : "\n" + findings);
}

}  // namespace mocurate
