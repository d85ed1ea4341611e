#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/links.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "eval/survey/survey_tally.h"
#include "job/config_loading.h"
#include "job/motion_files.h"
#include "job/protocols.h"
#include "job/run_folder.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"
#include "report/options.h"
#include "report/stages.h"
#include "report/survey.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPageFile = "survey.html";
constexpr const char* kKeyFile = "key.json";

std::string SurveyJsonText(const nlohmann::json& json) {
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

/// Motions of one source of a survey.
struct SurveyFiles {
  std::string name;
  MotionFiles files;
};

/// From --motions NAME=FILE, with --labels once for all or once for each. Error kUsage, kNotFound.
Expected<std::vector<SurveyFiles>> FilesOfSources(const SurveyMakeArguments& arguments, const ConfigRules& rules) {
  if (arguments.labels.size() > 1 && arguments.labels.size() != arguments.motions.size()) {
    return Fail(ErrorCode::kUsage,
                Counted(static_cast<long long>(arguments.labels.size()), "file") + " of labels for " +
                    Counted(static_cast<long long>(arguments.motions.size()), "source"),
                "--labels", "give one for all, or one for each --motions in the same order");
  }
  std::vector<SurveyFiles> sources;
  for (const std::string& text : arguments.motions) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      return Fail(ErrorCode::kUsage, "'" + text + "' is not NAME=FILE", "--motions",
                  "write e.g. --motions Action2Motion=generated.h5");
    }
    SurveyFiles source{text.substr(0, equals), {}};
    source.files.path = text.substr(equals + 1);
    std::error_code unknown;
    if (!fs::exists(source.files.path, unknown)) {
      return Fail(ErrorCode::kNotFound, "no such file or folder", DisplayPath(source.files.path),
                  "give --motions NAME=FILE with a dataset, or a file or folder of motions");
    }
    const bool ours = IsMotionStore(source.files.path);
    if (!ours) source.files.source = arguments.source;
    source.files.rules = rules;
    if (!arguments.labels.empty() && !(ours && arguments.labels.size() == 1)) {
      source.files.labels = arguments.labels[arguments.labels.size() > 1 ? sources.size() : 0];
    }
    sources.push_back(std::move(source));
  }
  return sources;
}

/// The body to draw motions with; empty for bones. Error kMissingOnHost, kNotFound.
Expected<fs::path> BodyOfSurvey(const SurveyMakeArguments& arguments) {
  const bool by_kind = arguments.figure.empty() && arguments.body.empty();
  if (arguments.figure == "bones" || (by_kind && arguments.kind == Name(SurveyKind::kRanking))) return fs::path();
  const fs::path body = arguments.body.empty() ? FindBody() : arguments.body;
  if (body.empty()) {
    return Fail(ErrorCode::kMissingOnHost, "no body is given, and none is below MOCURATE_WEIGHTS or MOCURATE_DATA",
                "--body",
                "put SMPL_NEUTRAL.pkl or body_cc0.h5 there, or give it with --body; --figure bones needs none");
  }
  if (std::error_code unknown; !fs::exists(body, unknown)) {
    return Fail(ErrorCode::kNotFound, "there is no such file", DisplayPath(body),
                "give --body SMPL_NEUTRAL.pkl or body_cc0.h5; --figure bones needs none");
  }
  return body;
}

void PrintSurvey(const SurveyMakeArguments& arguments, const nlohmann::json& summary) {
  const nlohmann::json& key = summary.at("key");
  Print("%s: %s about %s of %s; send it to the participants\n", DisplayPath(arguments.output / kPageFile).c_str(),
        Counted(static_cast<long long>(key.at("questions").size()), "question").c_str(),
        Counted(static_cast<long long>(key.at("labels").size()), "label").c_str(),
        Counted(static_cast<long long>(key.at("sources").size()), "source").c_str());
  Print("%s: the key of the motions; do not send it, `mocurate survey tally` needs it\n",
        DisplayPath(arguments.output / kKeyFile).c_str());
}

/// Valid answers, and reasons for excluded ones.
struct CollectedAnswers {
  std::vector<SurveyAnswers> answers;
  std::vector<std::pair<fs::path, Error>> bad;
};

CollectedAnswers CollectAnswers(const std::vector<fs::path>& files, const SurveyKey& key) {
  CollectedAnswers collected;
  std::map<std::string, fs::path> file_of;  // by participant
  for (const fs::path& file : files) {
    const auto bytes = ReadFile(file);
    auto answers = bytes ? ReadSurveyAnswers(*bytes, DisplayPath(file), key) : Forward(bytes);
    if (answers) {
      const auto [first, is_new] = file_of.emplace(answers->participant, file);
      if (!is_new) {
        answers = Fail(ErrorCode::kInconsistent,
                       "participant \"" + answers->participant + "\" has already answered in " +
                           DisplayPath(first->second) + "; each participant counts once",
                       DisplayPath(file) + ": /participant", "remove one of the two files, or give --skip-bad");
      }
    }
    if (answers) {
      collected.answers.push_back(std::move(*answers));
    } else {
      collected.bad.emplace_back(file, answers.error());
    }
  }
  return collected;
}

}  // namespace

Status SurveyMakeVerb(CommonArguments& common, const SurveyMakeArguments& arguments) {
  SurveyOptions options;
  const bool ranking = arguments.kind == Name(SurveyKind::kRanking);
  options.kind = ranking ? SurveyKind::kRanking : SurveyKind::kRealOrFake;
  if (!arguments.real.empty()) options.real = arguments.real;
  if (ranking && (!arguments.real.empty() || arguments.clips)) {
    return Fail(ErrorCode::kUsage, "--real and --clips do not apply to a survey of kind ranking",
                arguments.clips ? "--clips" : "--real", "remove the option, or make a survey of kind real_or_fake");
  }
  const auto body = BodyOfSurvey(arguments);
  if (!body) return Forward(body);
  options.questions = arguments.questions;
  options.clips = arguments.clips.value_or(options.clips);
  options.seed = arguments.seed;
  options.labels = arguments.ask;
  options.seconds = arguments.seconds;
  const auto sources = FilesOfSources(arguments, {common.allow_include});
  if (!sources) return Forward(sources);
  std::vector<fs::path> inputs;
  for (const SurveyFiles& source : *sources) inputs.push_back(source.files.path);
  inputs.insert(inputs.end(), arguments.labels.begin(), arguments.labels.end());
  if (!body->empty()) inputs.push_back(*body);
  const fs::path page = arguments.output / kPageFile, key = arguments.output / kKeyFile;
  if (Status free = CheckOutputs({page, key}, inputs, arguments.force); !free) return free;
  for (const fs::path& file : {page, key}) {
    if (Status plain = CheckNotLink(file); !plain) return plain;
  }
  ExtractorOptions extractor;
  if (!arguments.extractor.empty()) {
    auto loaded = LoadExtractor(arguments.extractor, {}, {common.allow_include});
    if (!loaded) return Forward(loaded);
    extractor = std::move(*loaded);
  }
  auto stages = VerbStages::Make(common);
  if (!stages) return Forward(stages);
  ItemSpec item{"survey", OptionsToJson(options), {}};
  for (const SurveyFiles& source : *sources) {
    auto input = MotionsInput(source.name, source.files, extractor,
                              "declare them with --extractor NAME (the recogniser's joints, axes and unit) or --source "
                              "DECLARATION",
                              **stages);
    if (!input) return Forward(input);
    item.inputs.push_back(std::move(*input));
  }
  if (!body->empty()) item.inputs.push_back({"body", body->filename().string(), *body, ""});
  const auto made = (*stages)->One(SurveyDeclaration(), std::move(item));
  if (!made) return Forward(made);
  if (Status folder = MakeFolder(arguments.output); !folder) return folder;
  if (Status copied = CopyWhole(made->artifact, page); !copied) return copied;
  const nlohmann::json summary = made->summary;
  if (Status written = WriteFile(key, SurveyJsonText(summary.at("key"))); !written) return written;
  for (const nlohmann::json& note : summary.at("notes")) LogWarning(note.get<std::string>());
  if (AnswersInText(common, {{"page", DisplayPath(page)},
                             {"key", DisplayPath(key)},
                             {"survey", summary.at("key").at("survey")},
                             {"questions", summary.at("key").at("questions").size()},
                             {"labels", summary.at("key").at("labels")},
                             {"motions", summary.at("motions")},
                             {"bytes", summary.at("bytes")},
                             {"notes", summary.at("notes")}})) {
    PrintSurvey(arguments, summary);
  }
  return {};
}

Status SurveyTallyVerb(CommonArguments& common, const SurveyTallyArguments& arguments) {
  std::vector<fs::path> inputs = arguments.answers;
  inputs.push_back(arguments.key);
  const auto output = [&](const char* name) { return arguments.output / name; };
  const std::vector<fs::path> outputs = {output("tally.json"), output("tally.csv"), output("differences.csv"),
                                         output("tally.md"), output("figure.svg")};
  if (Status free = CheckOutputs(outputs, inputs, arguments.force); !free) return free;
  for (const fs::path& file : outputs) {
    if (Status plain = CheckNotLink(file); !plain) return plain;
  }
  const auto bytes = ReadFile(arguments.key);
  if (!bytes) return Forward(bytes);
  const auto key = ReadSurveyKey(*bytes, DisplayPath(arguments.key));
  if (!key) return Forward(key);
  const CollectedAnswers collected = CollectAnswers(arguments.answers, *key);
  if (!collected.bad.empty() && !arguments.skip_bad) {
    for (std::size_t i = 1; i < collected.bad.size(); ++i) Log(LogLevel::kError, collected.bad[i].second.Message());
    return tl::unexpected<Error>(collected.bad.front().second);
  }
  nlohmann::ordered_json tally = TallySurvey(*key, collected.answers);
  for (const auto& [file, error] : collected.bad) {
    LogWarning("not counted: " + error.Message());
    tally["skipped"].push_back({{"file", DisplayPath(file)}, {"reason", error.Message()}});
  }
  if (Status folder = MakeFolder(arguments.output); !folder) return folder;
  const std::string markdown = TallyToMarkdown(tally);
  for (const auto& [name, text] :
       {std::pair("tally.json", SurveyJsonText(tally)), std::pair("tally.csv", TallyToCsv(tally.at("rows"))),
        std::pair("differences.csv", TallyToCsv(tally.at("differences"))), std::pair("tally.md", markdown),
        std::pair("figure.svg", TallyToSvg(tally, arguments.corner))}) {
    if (Status written = WriteFile(output(name), text); !written) return written;
  }
  if (AnswersInText(common, tally)) {
    Print("%s\nalso in %s as tally.json, tally.csv, differences.csv, tally.md, figure.svg\n", markdown.c_str(),
          DisplayPath(arguments.output).c_str());
  }
  return {};
}

}  // namespace mocurate
