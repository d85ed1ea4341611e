#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/job_options.h"
#include "app/verbs.h"
#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/resources.h"
#include "core/base/text.h"
#include "ingest/wanted_files.h"

namespace mocurate {
namespace {

constexpr const char* kFolder = "sources/";

std::vector<std::string> Recipes() {
  std::vector<std::string> names;
  for (const std::string& path : ResourcePaths()) {
    if (path.rfind(kFolder, 0) != 0) continue;
    const std::string file = path.substr(std::string(kFolder).size());
    names.push_back(file.substr(0, file.rfind('.')));
  }
  return names;
}

Expected<ConfigSource> RecipeOf(const std::string& name) {
  if (const auto text = FindResource(kFolder + name + ".yaml")) {
    // By its place among the embedded files, so that a recipe may include another that lies beside it.
    return ConfigSource{std::string(*text), "resource:" + std::string(kFolder) + name + ".yaml", {}};
  }
  std::error_code unknown;
  if (std::filesystem::is_regular_file(name, unknown)) {
    const Expected<std::string> text = ReadFile(name);
    if (!text) return Forward(text);
    return ConfigSource{*text, name, std::filesystem::absolute(name, unknown).parent_path()};
  }
  std::string list;
  for (const std::string& known : Recipes()) list += (list.empty() ? "" : ", ") + known;
  const std::optional<std::string> near = Nearest(name, Recipes());
  return Fail(ErrorCode::kUsage, "there is no recipe of that name", name,
              (near ? "did you mean '" + *near + "'? " : std::string()) + "known: " + list + "; or a config file");
}

/// The recipe's ingest group. A folder that stands in no variable is no error here: it is what is asked for.
Expected<IngestOptions> LoadRecipe(const std::string& name, const std::filesystem::path& path, bool& placed) {
  const Expected<ConfigSource> recipe = RecipeOf(name);
  if (!recipe) return Forward(recipe);
  std::vector<std::string> assignments;
  if (!path.empty()) assignments.push_back("ingest.path=" + path.string());
  Expected<ConfigNode> node = LoadConfig(*recipe, assignments);
  placed = node.has_value();
  if (!node) node = LoadConfig(*recipe, {"ingest.path=."});
  if (!node) return Forward(node);
  const auto job = OptionsFromConfig<JobOptions>(*node);
  if (!job) return Forward(job);
  placed = placed && !job->ingest.path.empty();
  return job->ingest;
}

}  // namespace

Status DoctorSourceVerb(CommonArguments& common, const DoctorArguments& arguments) {
  bool placed = false;
  const Expected<IngestOptions> ingest = LoadRecipe(arguments.source, arguments.path, placed);
  if (!ingest) return Forward(ingest);
  if (Status sound = CheckSource(ingest->source); !sound) return sound;
  std::error_code unknown;
  const bool there = placed && std::filesystem::is_directory(ingest->path, unknown);
  const Expected<std::vector<WantedFile>> wanted = WantedFiles(*ingest, there);
  if (!wanted) return Forward(wanted);
  const std::string folder = placed ? DisplayPath(ingest->path) : "";
  nlohmann::json document = {{"source", ingest->source.name}, {"licence", ingest->source.licence},
                             {"obtain", ingest->obtain},      {"path", folder},
                             {"path_exists", there},          {"files", nlohmann::json::array()}};
  std::size_t missing = 0;
  for (const WantedFile& file : *wanted) {
    missing += file.found == 0 ? 1 : 0;
    document["files"].push_back({{"pattern", file.pattern}, {"what", file.what}, {"found", file.found}});
  }
  document["ok"] = missing == 0;
  if (common.json) {
    std::printf("%s\n", document.dump(1).c_str());
  } else {
    std::printf("source   %s\nlicence  %s\n", ingest->source.name.c_str(),
                ingest->source.licence.empty() ? "not stated" : ingest->source.licence.c_str());
    if (!ingest->obtain.empty()) std::printf("obtain   %s\n", ingest->obtain.c_str());
    std::printf("folder   %s\n", !placed ? "not said: set ingest.path, or --path here"
                                         : (folder + (there ? "" : " (is not there)")).c_str());
    for (const WantedFile& file : *wanted) {
      std::printf("%-8s %s: %s", file.found > 0 ? "ok" : "MISSING", file.pattern.c_str(), file.what.c_str());
      std::printf(file.found > 0 ? " (%zu files)\n" : "\n", file.found);
    }
  }
  common.answered = common.json;
  if (missing == 0) return {};
  return Fail(
      ErrorCode::kMissingOnHost,
      std::to_string(missing) + " of " + std::to_string(wanted->size()) + " kinds of files are missing",
      arguments.source,
      placed ? "put them below " + folder + " under these names" : "put them into a folder and name it (--path DIR)");
}

}  // namespace mocurate
