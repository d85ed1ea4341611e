#include "core/store/describe_text.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/base/text.h"
#include "core/motion/clip.h"

namespace mocurate {
namespace {

constexpr std::size_t kColumn = 14;
constexpr std::size_t kMostNamed = 12;

std::string DurationText(double seconds) {
  return seconds < 120.0 ? RoundedText(seconds, 3) + " s" : RoundedText(seconds / 60.0, 3) + " min";
}

/// "12 clips, 960 frames": of the kinds that the file has.
std::string CountsText(const nlohmann::json& description) {
  const nlohmann::json& counts = description.at("counts");
  std::string text;
  for (const char* kind : {"clip", "frame", "segment", "finding", "track_frame", "view", "depth_image", "cloud"}) {
    const auto count = counts.find(std::string(kind) + "s");
    if (count == counts.end() || *count == 0) continue;
    std::string noun = kind;
    std::replace(noun.begin(), noun.end(), '_', ' ');
    text += (text.empty() ? "" : ", ") + Counted(count->get<long long>(), noun);
  }
  if (!description.contains("duration_s")) return text;
  return DurationText(description["duration_s"].get<double>()) + " in " + text;
}

/// What height 0 of the clips is.
std::string OriginText(const std::string& origin) {
  const std::pair<const char*, const char*> texts[] = {
      {kOriginRoot, "height 0 is the root in the anchor frame of each clip"},
      {kOriginFloor, "height 0 is the floor, as measured under the feet"},
      {kOriginSourceHeight, "height 0 is that of the source"},
      {kOriginSource, "the source's"},
      {"mixed", "not the same for all clips: `origin` of their provenance"}};
  for (const auto& [name, text] : texts) {
    if (origin == name) return origin + ": " + text;
  }
  return origin;
}

}  // namespace

std::string DescriptionLine(const std::string& name, const std::string& text) {
  if (text.empty()) return "";
  return "  " + name + std::string(name.size() < kColumn ? kColumn - name.size() : 1, ' ') + text + "\n";
}

std::string TallyText(const nlohmann::json& tally) {
  std::string text;
  std::size_t shown = 0;
  for (const auto& [name, count] : tally.items()) {
    if (shown++ == kMostNamed) break;
    text += (text.empty() ? "" : ", ") + (name.empty() ? "(none)" : name) + " (" + count.dump() + ")";
  }
  if (tally.size() > kMostNamed) text += " and " + std::to_string(tally.size() - kMostNamed) + " more";
  return tally.empty() ? "" : std::to_string(tally.size()) + ": " + text;
}

std::string StoreText(const nlohmann::json& description) {
  const auto text = [&description](const char* key) { return description.value(key, std::string()); };
  const nlohmann::json& counts = description.at("counts");
  std::string lines = text("schema") + ": " + text("purpose") + "\n";
  lines += DescriptionLine("made by", text("created_by"));
  lines += DescriptionLine("holds", CountsText(description));
  std::string skeleton = text("skeleton");
  if (!skeleton.empty() && counts.contains("joints")) {
    skeleton += ", " + Counted(counts["joints"].get<long long>(), "joint");
  }
  if (text("kinematics") == "joints") skeleton += ", positions only";
  lines += DescriptionLine("skeleton", skeleton);
  lines += DescriptionLine("rate", text("rate").empty() ? "" : text("rate") + " Hz");
  lines += DescriptionLine("axes", text("axes"));
  const nlohmann::json none = nlohmann::json::object();
  lines += DescriptionLine("origin", OriginText(description.value("about", none).value(kHeightOrigin, std::string())));
  lines += DescriptionLine("persons", TallyText(description.value("clips_per_person", none)));
  lines += DescriptionLine("labels", TallyText(description.value("clips_per_label", none)));
  lines += DescriptionLine("sources", TallyText(description.value("clips_per_source", none)));
  std::string splits;
  for (const nlohmann::json& split : description.at("splits")) {
    splits += (splits.empty() ? "" : ", ") + split.get<std::string>();
  }
  lines += DescriptionLine("splits", splits);
  lines += DescriptionLine("unknown", description.at("unknown").empty() ? "" : description.at("unknown").dump());
  lines += DescriptionLine("fields", std::to_string(description.at("fields").size()) + ", listed by --json");
  return lines;
}

}  // namespace mocurate
