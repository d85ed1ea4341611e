#include "job/verbs/reproduce.h"

#include <algorithm>
#include <cstdlib>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "job/named_configs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

nlohmann::json HoursOf(double hours) { return hours > 0.0 ? nlohmann::json(hours) : nlohmann::json(); }

/// A file below the folder MOCURATE_WEIGHTS; empty without the variable or the file.
fs::path PublishedFile(const fs::path& name) {
  const char* folder = std::getenv("MOCURATE_WEIGHTS");
  if (folder == nullptr || *folder == '\0' || name.empty()) return {};
  std::error_code unknown;
  const fs::path file = fs::path(folder) / name;
  return fs::is_regular_file(file, unknown) ? file : fs::path();
}

}  // namespace

Expected<nlohmann::json> ReleasedRows(const ReproduceOptions& item, const std::string& set, const fs::path& folder,
                                      const CommonArguments& common) {
  nlohmann::json rows = nlohmann::json::array();
  for (const ReleasedMotionsOptions& released : item.released) {
    EvalArguments asked;
    const fs::path motions = PublishedFile(released.motions), labels = PublishedFile(released.labels);
    asked.bone_lengths = PublishedFile(released.bone_lengths);
    const bool whole = asked.bone_lengths.empty() == released.bone_lengths.empty();
    if (released.set != set || motions.empty() || labels.empty() || !whole) continue;
    asked.protocol = released.protocol;
    asked.generated = {released.name + "=" + motions.string()};
    asked.labels = {labels};
    asked.output = folder / "released" / motions.parent_path().filename();
    CommonArguments own = common;
    own.json = false;
    own.quiet = true;
    if (Status scored = EvalVerb(own, asked); !scored) {
      if (scored.error().code == ErrorCode::kInterrupted) return Forward(scored);
      LogWarning("no row '" + released.name + "': " + scored.error().Message());
      continue;
    }
    const nlohmann::json table = ReadJson(asked.output / "tables/table.json").value_or(nullptr);
    if (!table.is_object()) continue;
    for (nlohmann::json row : table.value("rows", nlohmann::json::array())) {
      if (row.value("real", false)) continue;
      row["profile"] = "released";
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

Expected<LoadedJob> LoadPaperItem(const std::string& id, const std::string& profile,
                                  const std::vector<std::string>& assignments) {
  const auto source = NamedJob("papers/" + id);
  if (!source) {
    const std::vector<std::string> ids = PaperIds();
    std::string near;
    for (const std::string& one : ids) {  // for an item without its paper
      if (one.substr(one.find('/') + 1) == id) near += (near.empty() ? "" : " or ") + one;
    }
    if (near.empty()) near = Nearest(id, ids).value_or("");
    return Fail(ErrorCode::kUsage, "there is no item with that name", id,
                (near.empty() ? "" : "did you mean " + near + "? ") + "`mocurate reproduce list` names all");
  }
  std::vector<std::string> all = assignments;
  if (!profile.empty()) all.insert(all.begin(), "profile=" + profile);
  return LoadJob(*source, all);
}

Status TakeData(const std::vector<std::string>& given, JobOptions& options) {
  for (const std::string& text : given) {
    const std::size_t equals = text.find('=');
    std::vector<std::string> names;
    for (const DataSetOptions& set : options.data) names.push_back(set.name);
    const auto at = std::find(names.begin(), names.end(), text.substr(0, equals));
    if (equals == std::string::npos || at == names.end()) {
      const auto near = Nearest(text.substr(0, equals), names);
      return Fail(ErrorCode::kUsage, "the job has no set '" + text.substr(0, equals) + "'", "--data",
                  near ? "did you mean '" + *near + "=PATH'?" : "write NAME=PATH with a set of the job's `data`");
    }
    std::error_code unknown;
    options.data[static_cast<std::size_t>(at - names.begin())].path =
        std::filesystem::absolute(text.substr(equals + 1), unknown).lexically_normal();
  }
  return {};
}

nlohmann::json DescribePaperItem(const std::string& id, const JobOptions& options) {
  const ReproduceOptions& item = options.reproduce;
  nlohmann::json at_hand = nlohmann::json::array(), missing = nlohmann::json::array();
  for (const DataSetOptions& set : options.data) {
    if (!set.like.empty()) continue;
    if (!set.path.empty()) {
      at_hand.push_back(set.name);
      continue;
    }
    missing.push_back({{"name", set.name},
                       {"how", "--data " + set.name + "=PATH, your copy of it" +
                                   (set.substitute.empty() ? ""
                                                           : "; without it synthetic motions in the layout '" +
                                                                 set.substitute + "' are used")}});
  }
  for (const ReleasedMotionsOptions& released : item.released) {
    if (PublishedFile(released.motions).empty() || PublishedFile(released.labels).empty()) {
      missing.push_back({{"name", released.name},
                         {"how", "set MOCURATE_WEIGHTS to a folder with " + released.motions.generic_string() +
                                     " and " + released.labels.generic_string() +
                                     ", of Action2Motion's repository (checkpoints/vae), beside its model_file"}});
    } else {
      at_hand.push_back(released.name);
    }
  }
  bool body = std::any_of(item.surveys.begin(), item.surveys.end(),
                          [](const PaperSurveyOptions& survey) { return !survey.skeleton.empty(); });
  for (const NetworkOptions& network : options.train.networks) body = body || (network.enabled && network.NeedsBody());
  if (body) {
    const std::filesystem::path file = FindBody();
    const bool published = file.filename().string().rfind("body_cc0", 0) != 0 && !file.empty();
    if (published) {
      at_hand.push_back("SMPL's neutral body");
    } else {
      missing.push_back(
          {{"name", "SMPL's neutral body"},
           {"how", "SMPL_NEUTRAL.pkl below the folder MOCURATE_WEIGHTS; " +
                       (file.empty() ? std::string("body_cc0.h5 there or below MOCURATE_DATA is used instead")
                                     : DisplayPath(file.filename()) + " is used instead")}});
    }
  }
  return {{"id", id},
          {"kind", OptionsToJson(item).at("kind")},
          {"shows", item.shows},
          {"at_hand", std::move(at_hand)},
          {"missing", std::move(missing)},
          {"profiles", item.kind == PaperItem::kDiagram ? nlohmann::json::object()
                                                        : nlohmann::json{{"smoke", HoursOf(item.smoke_hours)},
                                                                         {"small", HoursOf(item.small_hours)},
                                                                         {"paper", HoursOf(item.paper_hours)}}}};
}

}  // namespace mocurate
