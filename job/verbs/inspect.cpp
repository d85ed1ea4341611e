#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/pipeline/stage_run.h"
#include "ingest/inspect/inspect.h"
#include "job/config_loading.h"
#include "job/motion_files.h"
#include "job/named_configs.h"
#include "job/run_and_capture.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/inspect_artifact.h"
#include "job/verbs/verbs.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kAtOnce = 100;  // files per process
constexpr double kLongest_s = 60.0;   // per file
constexpr const char* kProgram = "mocurate-video";

/// Throws what GuardJson takes.
Expected<VideoFacts> VideoFactsOf(const nlohmann::json& line, const fs::path& file) {
  if (line.contains("error")) {
    return Fail(ErrorCode::kMalformed, line.at("error").get<std::string>(), DisplayPath(file),
                line.value("hint", std::string()));
  }
  VideoFacts facts;
  facts.frames = line.value("frames", 0);
  facts.rate_hz = line.value("rate_hz", 0.0);
  facts.width = line.value("width", 0);
  facts.height = line.value("height", 0);
  facts.codec = line.value("codec", std::string());
  return facts;
}

using Answer = std::optional<Expected<VideoFacts>>;

/// Skips lines without the index of a requested file: a decoder's library may print as well.
void TakeAnswers(const std::string& text, const std::vector<std::size_t>& asked, const std::vector<fs::path>& files,
                 std::vector<Answer>& answers) {
  for (const std::string_view written : SplitText(text, '\n')) {
    const auto line = ParseJson(written, "");
    if (!line || !line->is_object() || !line->contains("index") || !line->at("index").is_number_unsigned()) continue;
    const auto index = line->at("index").get<std::size_t>();
    if (index >= asked.size() || answers[asked[index]]) continue;
    const fs::path& file = files[asked[index]];
    answers[asked[index]] = GuardJson(DisplayPath(file), [&] { return VideoFactsOf(*line, file); });
  }
}

/// Runs the program mocurate-video beside this one. Error kMissingOnHost if it is missing or does not start. A file
/// that crashes it, or has no answer within 60 s, is kMalformed; the others are requested again.
std::vector<Expected<VideoFacts>> AskVideoProgram(const std::vector<fs::path>& files) {
  std::vector<Answer> answers(files.size());
  const auto unanswered = [&](std::size_t most) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < files.size() && found.size() < most; ++i) {
      if (!answers[i]) found.push_back(i);
    }
    return found;
  };
  const auto program = FindWorkerProgram(RunnerOptions(), kProgram);
  while (program) {
    const std::vector<std::size_t> asked = unanswered(kAtOnce);
    if (asked.empty()) break;
    std::vector<std::string> arguments;
    for (const std::size_t i : asked) arguments.push_back(fs::absolute(files[i]).native());
    const ProgramAnswer answer = RunAndCapture(*program, arguments, CaptureOptions{false, kLongest_s});
    TakeAnswers(answer.text, asked, files, answers);
    const auto silent = std::find_if(asked.begin(), asked.end(), [&](std::size_t i) { return !answers[i]; });
    if (silent == asked.end()) continue;
    if (answer.exit_status > 0) break;  // it does not start
    const std::string what = answer.timed_out
                                 ? "the decoder did not open the file within " + FormatDouble(kLongest_s) + " s"
                                 : std::string("the decoder crashed on the file");
    answers[*silent] =
        Fail(ErrorCode::kMalformed, what, DisplayPath(files[*silent]), "check that the file is complete and plays");
  }
  std::vector<Expected<VideoFacts>> facts;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (answers[i]) {
      facts.push_back(std::move(*answers[i]));
    } else {
      facts.push_back(Fail(ErrorCode::kMissingOnHost, std::string(kProgram) + " is missing or does not start",
                           DisplayPath(files[i]), "run `mocurate doctor` to list what is missing"));
    }
  }
  return facts;
}

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

/// The first finding of severity error as the verb's error, without clips; one about the declaration with clips too.
Status FirstError(const Inspection& inspection) {
  for (const Finding& finding : inspection.findings) {
    const bool declaration = finding.code == Name(ErrorCode::kConfig) || finding.code == "units_unknown" ||
                             finding.code == "unknown_skeleton";
    if (declaration) return Fail(ErrorCode::kConfig, finding.message, finding.clip);
    if (finding.severity != Severity::kError || !inspection.clips.empty()) continue;
    return Fail(ErrorCode::kMalformed, finding.message, finding.clip);
  }
  return {};
}

/// Reports an unreadable path in the form of every answer.
Status Unreadable(CommonArguments& common, const std::filesystem::path& path, const Error& error) {
  AnswersInText(common, {{"path", DisplayPath(path)},
                         {"format", "unknown"},
                         {"clips", nlohmann::json::array()},
                         {"findings",
                          {{{"code", Name(error.code)},
                            {"severity", "error"},
                            {"where", error.where.empty() ? DisplayPath(path) : error.where},
                            {"value", nullptr},
                            {"message", error.what}}}}});
  return tl::unexpected<Error>(error);
}

/// A config, or a source declaration by its name; a declaration whose folder variable is unset applies to the inspected
/// files.
Expected<SourceOptions> LoadSource(const std::string& name, const ConfigRules& rules) {
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
    if (AnswersInText(common, *description)) Print("%s", MadeText(arguments.path, *description).c_str());
    return {};
  }
  std::optional<SourceOptions> source;
  std::string declaration = arguments.source.string();
  if (const auto beside = declaration.empty() ? DeclarationBeside(arguments.path) : std::nullopt) {
    LogInfo("read by the declaration beside the files, " + DisplayPath(*beside));
    declaration = beside->string();
  }
  if (!declaration.empty()) {
    Expected<SourceOptions> declared = LoadSource(declaration, {common.allow_include});
    if (!declared) return Forward(declared);
    source = *std::move(declared);
  }
  const InspectProgress progress = common.quiet ? InspectProgress() : PrintProgress();
  const Inspection inspection = InspectPath(arguments.path, source, AskVideoProgram, progress);
  if (AnswersInText(common, inspection)) Print("%s", InspectionText(inspection).c_str());
  return FirstError(inspection);
}

}  // namespace mocurate
