#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "ingest/inspect/inspect.h"
#include "job/config_loading.h"
#include "job/named_configs.h"
#include "job/verbs/inspect_artifact.h"
#include "job/verbs/verbs.h"
#include "job/verbs/video_probe.h"

namespace mocurate {
namespace {

/// Logs the progress of a large folder on stderr.
InspectProgress PrintProgress() {
  using Clock = std::chrono::steady_clock;
  return [logged = Clock::now()](std::size_t done, std::size_t all) mutable {
    constexpr std::chrono::seconds kEvery{3};
    if (done == all || Clock::now() - logged < kEvery) return;
    logged = Clock::now();
    LogInfo(std::to_string(done) + " of " + std::to_string(all) + " files read");
  };
}

/// The first finding of severity error as the verb's error, without clips.
Status FirstError(const Inspection& inspection) {
  for (const Finding& finding : inspection.findings) {
    if (finding.severity != Severity::kError || !inspection.clips.empty()) continue;
    return Fail(ErrorCode::kMalformed, finding.message, finding.clip);
  }
  return {};
}

/// Reports an unreadable path in the form of every answer.
Status Unreadable(CommonArguments& common, const std::filesystem::path& path, const Error& error) {
  if (common.json) {
    PrintJson({{"path", DisplayPath(path)},
               {"format", "unknown"},
               {"clips", nlohmann::json::array()},
               {"findings",
                {{{"code", Name(error.code)},
                  {"severity", "error"},
                  {"where", error.where.empty() ? DisplayPath(path) : error.where},
                  {"value", nullptr},
                  {"message", error.what}}}}});
    common.answered = true;
  }
  return tl::unexpected<Error>(error);
}

/// A config, or a source declaration by its name; a declaration whose folder variable is unset applies to the inspected
/// files.
Expected<SourceOptions> LoadSource(const InspectArguments& arguments, const ConfigRules& rules) {
  const std::string name = arguments.source.string();
  const Expected<ConfigSource> source = SourceOf(name);
  if (!source) return Forward(source);
  auto job = LoadJob(*source, {}, rules);
  if (!job && NamedSource(name)) job = LoadJob(*source, {"ingest.path=."}, rules);
  if (!job) return Forward(job);
  return job->options.ingest.source;
}

}  // namespace

Status InspectVerb(CommonArguments& common, const InspectArguments& arguments) {
  std::error_code ignored;
  if (!std::filesystem::exists(arguments.path, ignored)) {
    return Unreadable(common, arguments.path,
                      {ErrorCode::kNotFound, "there is no such file or folder", DisplayPath(arguments.path), ""});
  }
  if (!std::filesystem::is_directory(arguments.path, ignored) &&
      !std::filesystem::is_regular_file(arguments.path, ignored)) {
    return Unreadable(common, arguments.path,
                      {ErrorCode::kUnreadable, "is not a regular file", DisplayPath(arguments.path),
                       "pipes and devices are not read; save the data to a file"});
  }
  if (IsMade(arguments.path)) {
    const auto description = DescribeMade(arguments.path);
    if (!description) return Unreadable(common, arguments.path, description.error());
    common.answered = common.json;
    if (common.json)
      PrintJson(*description);
    else
      Print("%s", MadeText(arguments.path, *description).c_str());
    return {};
  }
  std::optional<SourceOptions> source;
  if (!arguments.source.empty()) {
    Expected<SourceOptions> declared = LoadSource(arguments, {common.allow_include});
    if (!declared) return Forward(declared);
    source = *std::move(declared);
  }
  const InspectProgress progress = common.quiet ? InspectProgress() : PrintProgress();
  const Inspection inspection = InspectPath(arguments.path, source, AskVideoProgram(), progress);
  common.answered = common.json;
  if (common.json)
    PrintJson(inspection);
  else
    Print("%s", InspectionText(inspection).c_str());
  return FirstError(inspection);
}

}  // namespace mocurate
