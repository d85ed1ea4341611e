#include "job/named_configs.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "core/base/file.h"
#include "core/base/resources.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr const char* kJobFolders[] = {"", "reannotate/"};  // below configs/
constexpr const char* kPapers = "papers/";
constexpr const char* kPaperFolders[] = {"papers/a2m/", "papers/actor/", "papers/multiact/"};
constexpr const char* kReproduces = "\nreproduce:";  // first key of papers' jobs; included parts do not have it
constexpr const char* kSourceFolder = "sources/";
constexpr const char* kEnding = ".yaml";
constexpr const char* kEmbedded = "resource:";

std::vector<std::string> JobNames() {
  std::vector<std::string> names;
  for (const char* folder : kJobFolders) {
    for (const std::string& name : NamesIn(folder)) names.push_back(folder + name);
  }
  for (const std::string& id : PaperIds()) names.push_back(kPapers + id);
  return names;
}

/// Source with its path among the embedded files, so that it can include others relative to it.
ConfigSource Embedded(const std::string& name) {
  const std::string file = name + kEnding;
  return {std::string(FindResource(file).value_or("")), kEmbedded + file, {}};
}

bool IsOneOf(const std::string& name, const std::vector<std::string>& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The nearest job: the same name in a folder ("ntu": "reannotate/ntu"), else the most similar name.
std::optional<std::string> NearestJob(const std::string& name, const std::vector<std::string>& jobs) {
  const std::filesystem::path file = std::filesystem::path(name).filename();
  for (const std::string& job : jobs) {
    if (std::filesystem::path(job).filename() == file) return job;
  }
  return Nearest(name, jobs);
}

}  // namespace

std::vector<std::string> NamesIn(const std::string& folder) {
  std::vector<std::string> names;
  for (const std::string& path : ResourcePaths()) {
    if (path.substr(0, path.rfind('/') + 1) == folder)
      names.push_back(path.substr(folder.size(), path.rfind('.') - folder.size()));
  }
  return names;
}

Expected<ConfigNode> LoadNamed(const std::string& folder, const std::string& what, const std::string& name,
                               const std::vector<std::string>& assignments, const ConfigRules& rules) {
  if (FindResource(folder + name + kEnding)) return LoadConfig(Embedded(folder + name), assignments);
  std::error_code unknown;
  if (std::filesystem::is_regular_file(name, unknown)) {
    return LoadConfig(std::filesystem::path(name), assignments, rules);
  }
  return Fail(ErrorCode::kUsage, "there is no " + what + " with that name", name,
              NearestOfAll(name, NamesIn(folder), "known: ") + "; or a YAML file");
}

std::vector<std::string> PaperIds() {
  std::vector<std::string> ids;
  for (const char* folder : kPaperFolders) {
    for (const std::string& name : NamesIn(folder)) {
      const std::string_view text = FindResource(folder + name + kEnding).value_or("");
      if (text.find(kReproduces) != std::string_view::npos)
        ids.push_back((folder + name).substr(std::string_view(kPapers).size()));
    }
  }
  return ids;
}

std::optional<ConfigSource> NamedJob(const std::string& name) {
  if (!IsOneOf(name, JobNames())) return std::nullopt;
  return Embedded(name);
}

std::string JobNameOf(const ConfigSource& source) {
  const std::string head = kEmbedded;
  if (source.name.compare(0, head.size(), head) != 0) return source.name;
  return std::filesystem::path(source.name.substr(head.size())).replace_extension().string();
}

Error NoJob(const std::string& name) {
  const std::vector<std::string> jobs = JobNames();
  const std::optional<std::string> near = NearestJob(name, jobs);
  const bool source = IsOneOf(name, NamesIn(kSourceFolder));
  return {ErrorCode::kConfig,
          source ? "a source declaration is not a job: it declares files, not how to process them"
                 : "there is no job with that name",
          name,
          (near ? "did you mean '" + *near + "'? " : std::string()) + "the jobs are: " + JoinTexts(jobs) +
              (source ? "; inspect, fit and doctor accept --source " + name : "; or a config file")};
}

std::optional<ConfigSource> NamedSource(const std::string& name) {
  if (!IsOneOf(name, NamesIn(kSourceFolder))) return std::nullopt;
  return Embedded(kSourceFolder + name);
}

Expected<ConfigSource> SourceOf(const std::string& name) {
  if (std::optional<ConfigSource> source = NamedSource(name)) return *std::move(source);
  std::error_code unknown;
  if (std::filesystem::is_regular_file(name, unknown)) {
    Expected<ConfigSource> source = ReadConfigFile(name);
    if (source) source->base_folder = std::filesystem::absolute(name, unknown).parent_path();
    return source;
  }
  if (std::filesystem::is_directory(name, unknown)) {
    return Fail(ErrorCode::kUsage, "is a folder, not a config file", name,
                "`mocurate config init " + name + "` writes one for the files in it");
  }
  return Fail(ErrorCode::kUsage, "there is no source declaration with that name", name,
              NearestOfAll(name, NamesIn(kSourceFolder), "known: ") + "; or a config file");
}

}  // namespace mocurate
