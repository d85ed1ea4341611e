#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/text.h"
#include "core/motion/clip.h"
#include "core/store/content_file.h"
#include "core/store/store.h"

namespace mocurate {
namespace {

using store::Content;
using store::Field;
using store::Schema;

Expected<const Schema*> SchemaOf(const store::Hdf5Reader& reader) {
  const std::string where = store::Where(reader.file(), "/@schema");
  if (!reader.Has("/@schema")) {
    return Fail(ErrorCode::kMalformed, "is missing; this HDF5 file was not written by mocurate", where);
  }
  auto name = reader.Read("/@schema", store::FieldType::kText);
  if (!name) return Forward(name);
  const std::string& found = name->as<std::string>()[0];
  std::string known, again;
  for (const Schema* schema : store::AllSchemas()) {
    if (schema->name == found) return schema;
    if (store::AreVersions(schema->name, found)) again = schema->MakeAgain();
    known += (known.empty() ? "" : ", ") + schema->name;
  }
  return Fail(ErrorCode::kMalformed, "is '" + found + "'; known are " + known, where, again);
}

/// Extents of the symbols by name: {"clips": 12, "frames": 960, ...}.
nlohmann::json CountsOf(const Schema& schema, const Content& content) {
  const std::map<std::string, std::string> names = {
      {"C", "clips"},        {"F", "frames"},    {"J", "joints"},         {"S", "segments"},        {"L", "labels"},
      {"N", "findings"},     {"M", "landmarks"}, {"K", "tracked_points"}, {"T", "track_frames"},    {"V", "views"},
      {"D", "depth_images"}, {"E", "keypoints"}, {"W", "keypoint_views"}, {"I", "keypoint_images"}, {"G", "clouds"}};
  nlohmann::json counts = nlohmann::json::object();
  for (const Field& field : store::ConcreteFields(schema, content)) {
    const store::Array* array = content.Find(field.path);
    for (std::size_t i = 0; array != nullptr && i < field.shape.size(); ++i) {
      const auto name = names.find(field.shape[i]);
      if (name != names.end()) counts[name->second] = array->shape[i];
    }
  }
  return counts;
}

nlohmann::json FieldsOf(const Schema& schema, const Content& content) {
  nlohmann::json fields = nlohmann::json::array();
  for (const Field& field : store::ConcreteFields(schema, content)) {
    const store::Array* array = content.Find(field.path);
    if (array == nullptr) continue;
    fields.push_back({{"path", DisplayPath(field.path)},
                      {"type", store::Name(field.type)},
                      {"shape", array->shape},
                      {"unit", field.unit},
                      {"meaning", field.meaning}});
  }
  return fields;
}

Expected<nlohmann::json> UnknownPaths(const Schema& schema, const Content& content, const store::Hdf5Reader& reader) {
  std::set<std::string> known;
  for (const Field& field : store::ConcreteFields(schema, content)) known.insert(field.path);
  nlohmann::json unknown = nlohmann::json::array();
  const auto paths = reader.AllPaths();
  if (!paths) return Forward(paths);
  for (const std::string& path : *paths) {
    if (known.count(path) == 0) unknown.push_back(DisplayPath(path));
  }
  return unknown;
}

double Seconds(const Content& content, const std::string& prefix) {
  double seconds = 0.0;
  const auto& counts = content.Values<std::int64_t>(prefix + "/clips/count");
  const auto& rates = content.Values<std::string>(prefix + "/clips/rate");
  for (std::size_t i = 0; i < counts.size(); ++i) seconds += FrameRate::Parse(rates[i])->FrameTime(counts[i]);
  return seconds;
}

/// How often each text occurs.
nlohmann::json Tally(const std::vector<std::string>& texts) {
  nlohmann::json tally = nlohmann::json::object();
  for (const std::string& text : texts) {
    nlohmann::json& count = tally[DisplayPath(text)];
    count = count.is_null() ? 1 : count.get<int>() + 1;
  }
  return tally;
}

}  // namespace

bool IsStoreFile(const std::filesystem::path& path) {
  const auto reader = store::Hdf5Reader::Open(path);
  return reader && SchemaOf(*reader);
}

bool HasStoredRotations(const std::filesystem::path& path) {
  const auto reader = store::Hdf5Reader::Open(path);
  return reader && reader->Has("/frames/rotation");
}

Expected<nlohmann::json> DescribeStore(const std::filesystem::path& path) {
  auto reader = store::Hdf5Reader::Open(path);
  if (!reader) return Forward(reader);
  const auto schema = SchemaOf(*reader);
  if (!schema) return Forward(schema);
  auto content = store::ReadContent(**schema, *reader);
  if (!content) return Forward(content);
  auto unknown = UnknownPaths(**schema, *content, *reader);
  if (!unknown) return Forward(unknown);
  nlohmann::json json = {{"schema", (*schema)->name},
                         {"purpose", (*schema)->purpose},
                         {"bytes", reader->bytes()},
                         {"content_sha256", content->Text("/@content_sha256")},
                         {"kinematics", content->Text("/@kinematics")},
                         {"counts", CountsOf(**schema, *content)},
                         {"fields", FieldsOf(**schema, *content)},
                         {"unknown", std::move(*unknown)}};
  for (const char* name : {"skeleton", "rate", "axes", "created_by"}) {
    if (content->Has(std::string("/@") + name)) json[name] = DisplayPath(content->Text(std::string("/@") + name));
  }
  if (*schema == &store::DatasetSchema() && content->Has("/about")) {
    auto about = ParseJson(content->Text("/about"), DisplayPath(path) + ":/about");
    if (!about) return Forward(about);
    json["about"] = *std::move(about);
  }
  if (content->Has((*schema)->prefix + "/clips/count")) json["duration_s"] = Seconds(*content, (*schema)->prefix);
  if (content->Has("/clips/person")) {
    json["clips_per_person"] = Tally(content->Values<std::string>("/clips/person"));
    json["clips_per_label"] = Tally(content->Values<std::string>("/clips/label"));
    json["clips_per_source"] = Tally(content->Values<std::string>("/clips/source"));
  }
  json["splits"] = nlohmann::json::array();
  for (const std::string& name : content->splits) json["splits"].push_back(DisplayPath(name));
  return json;
}
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
