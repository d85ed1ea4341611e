#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "ingest/expected_files.h"
#include "job/job_options.h"
#include "job/named_configs.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

/// The ingest group of a source declaration. A folder whose environment variable is not set is no error here: the verb
/// reports it.
Expected<IngestOptions> LoadIngest(const std::string& name, const std::filesystem::path& path, const ConfigRules& rules,
                                   bool& placed) {
  const Expected<ConfigSource> source = SourceOf(name);
  if (!source) return Forward(source);
  std::vector<std::string> assignments;
  if (!path.empty()) assignments.push_back("ingest.path=" + path.string());
  Expected<ConfigNode> node = LoadConfig(*source, assignments, rules);
  placed = node.has_value();
  if (!node) node = LoadConfig(*source, {"ingest.path=."}, rules);
  if (!node) return Forward(node);
  const auto job = OptionsFromConfig<JobOptions>(*node);
  if (!job) return Forward(job);
  placed = placed && !job->ingest.path.empty();
  return job->ingest;
}

nlohmann::json Entry(const ExpectedFile& file) {
  nlohmann::json entry = {{"pattern", file.pattern}, {"what", file.what}, {"found", file.found}};
  if (file.found == 0 && file.found_elsewhere > 0)
    entry["elsewhere"] = {{"path", DisplayPath(file.elsewhere)}, {"found", file.found_elsewhere}};
  if (file.others > 0) entry["other_names"] = {{"files", file.others}, {"first", file.other}};
  return entry;
}

/// Folders with the searched files, and files with similar names.
std::string RemarkOfFile(const ExpectedFile& file) {
  std::string remark;
  if (file.found == 0 && file.found_elsewhere > 0) {
    remark = "; " + Counted(static_cast<long long>(file.found_elsewhere), "such file") + " below " +
             DisplayPath(file.elsewhere);
  } else if (file.others > 0) {
    remark = "; " + Counted(static_cast<long long>(file.others), "file") + " with this ending and another name, e.g. " +
             file.other;
  }
  return remark;
}

}  // namespace

Status DoctorSourceVerb(CommonArguments& common, const DoctorArguments& arguments) {
  bool placed = false;
  const Expected<IngestOptions> ingest = LoadIngest(arguments.source, arguments.path, {common.allow_include}, placed);
  if (!ingest) return Forward(ingest);
  if (Status sound = CheckSource(ingest->source); !sound) return sound;
  std::error_code unknown;
  const bool there = placed && std::filesystem::is_directory(ingest->path, unknown);
  const bool made = ingest->synthetic.enabled && !placed;
  const Expected<std::vector<ExpectedFile>> wanted = made ? std::vector<ExpectedFile>() : ExpectedFiles(*ingest, there);
  if (!wanted) return Forward(wanted);
  const std::string folder = placed ? DisplayPath(ingest->path) : "";
  nlohmann::json document = {{"source", ingest->source.name}, {"licence", ingest->source.licence},
                             {"obtain", ingest->obtain},      {"path", folder},
                             {"path_exists", there},          {"files", nlohmann::json::array()}};
  std::size_t missing = 0;
  std::filesystem::path elsewhere;
  for (const ExpectedFile& file : *wanted) {
    missing += file.found == 0 ? 1 : 0;
    if (file.found == 0 && elsewhere.empty()) elsewhere = file.elsewhere;
    document["files"].push_back(Entry(file));
  }
  document["ok"] = missing == 0;
  if (common.json) {
    PrintJson(document);
  } else {
    Print("source   %s\nlicence  %s\n", ingest->source.name.c_str(),
          ingest->source.licence.empty() ? "not stated" : ingest->source.licence.c_str());
    if (!ingest->obtain.empty()) Print("obtain   %s\n", ingest->obtain.c_str());
    Print("folder   %s\n", made      ? "none: the program generates the files"
                           : !placed ? "unknown: set ingest.path, or use --path here"
                                     : (folder + (there ? "" : " (does not exist)")).c_str());
    for (const ExpectedFile& file : *wanted) {
      Print("%-8s %s: %s", file.found > 0 ? "ok" : "MISSING", file.pattern.c_str(), file.what.c_str());
      if (file.found > 0) Print(" (%zu files)", file.found);
      Print("%s\n", RemarkOfFile(file).c_str());
    }
  }
  common.answered = common.json;
  if (missing == 0) return {};
  return Fail(ErrorCode::kMissingOnHost,
              std::to_string(missing) + " of " + std::to_string(wanted->size()) + " kinds of files are missing",
              arguments.source,
              !elsewhere.empty()
                  ? "files with these names are below " + DisplayPath(elsewhere) + ": name that folder (--path)"
              : placed ? "put them below " + folder + " under these names"
                       : "put them into a folder and give it as --path DIR");
}

}  // namespace mocurate
