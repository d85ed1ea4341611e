#include "canon/card/dataset_card.h"

#include <map>
#include <nlohmann/json.hpp>

#include "canon/splits/leaks.h"
#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/base/table_text.h"
#include "core/base/text.h"
#include "core/store/dataset_clips.h"

namespace mocurate {
namespace {

/// A cell of a Markdown table.
std::string Cell(const std::string& text) { return text.empty() ? "-" : MarkdownText(text); }

/// "a 3, b 5"
std::string CountsText(const nlohmann::json& counts) {
  std::string text;
  for (const auto& [name, count] : counts.items()) {
    text += (text.empty() ? "" : ", ") + (name.empty() ? std::string("unknown") : name) + " " +
            std::to_string(count.get<long long>());
  }
  return text.empty() ? "none" : text;
}

}  // namespace

Expected<nlohmann::json> DescribeDataset(const std::filesystem::path& path) {
  const auto clips = DatasetClips::Open(path, DatasetClips::Check::kHashes);
  if (!clips) return Forward(clips);
  const auto sha256 = Sha256OfFile(path);
  if (!sha256) return Forward(sha256);
  std::error_code unknown;
  nlohmann::json card = {{"name", path.stem().string()},
                         {"file", path.filename().string()},
                         {"bytes", std::filesystem::file_size(path, unknown)},
                         {"sha256", *sha256},
                         {"recipe", clips->recipe()},
                         {"created_by", clips->created_by()},
                         {"skeleton", clips->skeleton() ? clips->skeleton()->name : ""},
                         {"joints", clips->skeleton() ? clips->skeleton()->joint_count() : 0},
                         {"axes", clips->axes().Text()},
                         {"clips", clips->size()}};
  struct ClassCount {
    int clips = 0;
    double seconds = 0.0;
  };
  std::map<std::string, ClassCount> classes;
  std::map<std::string, int> persons, sources, licences, rates;
  std::int64_t frames = 0;
  double seconds = 0.0;
  bool rotations = false;
  for (std::size_t row = 0; row < clips->size(); ++row) {
    const auto clip = clips->Read(row);
    if (!clip) return Forward(clip);
    ++persons[clip->identity.person];
    ++sources[clip->identity.source];
    ++licences[clip->identity.licence];
    ++rates[RoundedText(clip->rate.hz(), 6) + " Hz"];
    ClassCount& own = classes[clip->label];
    ++own.clips;
    if (!clip->motion) continue;
    rotations = rotations || !clip->motion->joints_only();
    frames += clip->motion->frame_count();
    seconds += clip->motion->duration();
    own.seconds += clip->motion->duration();
  }
  card["rotations"] = rotations;
  card["frames"] = frames;
  card["seconds"] = seconds;
  card["persons"] = persons;
  card["sources"] = sources;
  card["licences"] = licences;
  card["rates"] = rates;
  card["classes"] = nlohmann::json::array();
  for (const std::string& label : clips->labels()) {
    const ClassCount own = classes[label];
    card["classes"].push_back({{"name", label}, {"clips", own.clips}, {"seconds", own.seconds}});
    classes.erase(label);
  }
  for (const auto& [label, own] : classes) {  // of no class of the set
    card["classes"].push_back({{"name", label.empty() ? "(no label)" : label + " (no class)"},
                               {"clips", own.clips},
                               {"seconds", own.seconds}});
  }
  card["splits"] = nlohmann::json::array();
  for (const Split& split : clips->splits()) {
    card["splits"].push_back(SplitSummary(split));
  }
  std::map<std::string, int> findings;
  for (const std::string& code : clips->finding_codes()) ++findings[code];
  card["findings"] = findings;
  return card;
}

std::string CardMarkdown(const nlohmann::json& card) {
  const auto number = [&](const char* key) { return std::to_string(card.at(key).get<long long>()); };
  std::string text = "# " + MarkdownText(card.at("name").get<std::string>()) + "\n\n";
  const std::string recipe = card.at("recipe").get<std::string>();
  if (!recipe.empty()) text += MarkdownText(recipe) + ".\n\n";
  text += "| | |\n|---|---|\n";
  const std::pair<const char*, std::string> rows[] = {
      {"clips", number("clips")},
      {"frames", number("frames") + ", " + RoundedText(card.at("seconds").get<double>() / 60.0, 3) + " minutes"},
      {"rates", CountsText(card.at("rates"))},
      {"persons", std::to_string(card.at("persons").size()) + ": " + CountsText(card.at("persons"))},
      {"sources", CountsText(card.at("sources"))},
      {"licences", CountsText(card.at("licences"))},
      {"skeleton", card.at("skeleton").get<std::string>() + ", " + number("joints") + " joints, " +
                       (card.at("rotations").get<bool>() ? "rotations and joints" : "joints only")},
      {"findings", CountsText(card.at("findings"))},
      {"made by", card.at("created_by").get<std::string>()},
      {"file", card.at("file").get<std::string>() + ", " + number("bytes") + " bytes, sha256 " +
                   card.at("sha256").get<std::string>()}};
  for (const auto& [name, value] : rows) text += std::string("| ") + name + " | " + Cell(value) + " |\n";
  text += "\n| class | clips | seconds |\n|---|---|---|\n";
  for (const nlohmann::json& one : card.at("classes")) {
    text += "| " + Cell(one.at("name").get<std::string>()) + " | " + std::to_string(one.at("clips").get<int>()) +
            " | " + RoundedText(one.at("seconds").get<double>(), 4) + " |\n";
  }
  if (!card.at("splits").empty()) {
    text += "\n| split | train | validation | test | rule | leaks |\n|---|---|---|---|---|---|\n";
    for (const nlohmann::json& split : card.at("splits")) {
      text += "| " + Cell(split.at("name").get<std::string>());
      for (const char* part : {"train", "validation", "test"}) {
        text += " | " + std::to_string(split.at(part).get<long long>());
      }
      text += " | " + Cell(split.at("rule").get<std::string>()) + " | " +
              Cell(split.at("leak_check").get<std::string>()) + " |\n";
    }
  }
  text += "\nUnits: metres, seconds, radians; axes " + card.at("axes").get<std::string>() +
          " (+x +y +z: y up, facing +z); quaternions (w, x, y, z).\n";
  return text;
}

nlohmann::json CardCroissant(const nlohmann::json& card) {
  nlohmann::json licences = nlohmann::json::array(), classes = nlohmann::json::array();
  for (const auto& [licence, count] : card.at("licences").items()) {
    if (!licence.empty()) licences.push_back(licence);
  }
  for (const nlohmann::json& one : card.at("classes")) {
    classes.push_back({{"classes/name", one.at("name")}, {"classes/clips", one.at("clips")}});
  }
  const std::string recipe = card.at("recipe").get<std::string>();
  return {{"@context",
           {{"@language", "en"},
            {"@vocab", "https://schema.org/"},
            {"sc", "https://schema.org/"},
            {"cr", "http://mlcommons.org/croissant/"},
            {"dct", "http://purl.org/dc/terms/"},
            {"conformsTo", "dct:conformsTo"},
            {"recordSet", "cr:recordSet"},
            {"field", "cr:field"},
            {"dataType", {{"@id", "cr:dataType"}, {"@type", "@vocab"}}},
            {"data", {{"@id", "cr:data"}, {"@type", "@json"}}}}},
          {"@type", "sc:Dataset"},
          {"conformsTo", "http://mlcommons.org/croissant/1.0"},
          {"name", card.at("name")},
          {"description", recipe.empty() ? "Human motion clips with labels and splits" : recipe},
          {"license", licences},
          {"sdVersion", card.at("created_by")},
          {"distribution",
           {{{"@type", "cr:FileObject"},
             {"@id", card.at("file")},
             {"name", card.at("file")},
             {"contentUrl", card.at("file")},
             {"contentSize", std::to_string(card.at("bytes").get<long long>()) + " B"},
             {"encodingFormat", "application/x-hdf5"},
             {"sha256", card.at("sha256")}}}},
          {"recordSet",
           {{{"@type", "cr:RecordSet"},
             {"@id", "classes"},
             {"name", "classes"},
             {"field",
              {{{"@type", "cr:Field"}, {"@id", "classes/name"}, {"name", "name"}, {"dataType", "sc:Text"}},
               {{"@type", "cr:Field"}, {"@id", "classes/clips"}, {"name", "clips"}, {"dataType", "sc:Integer"}}}},
             {"data", classes}}}}};
}

}  // namespace mocurate
