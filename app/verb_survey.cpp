#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/dataset_stages.h"
#include "app/motion_files.h"
#include "app/output_checks.h"
#include "app/protocols.h"
#include "app/run_outputs.h"
#include "app/verbs.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "report/options.h"
#include "report/survey_tally.h"

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

/// Of --motions NAME=FILE, with --labels once for all or once for each. Error kUsage, kNotFound.
Expected<std::vector<SurveyFiles>> FilesOfSources(const SurveyMakeArguments& arguments) {
  if (arguments.labels.size() > 1 && arguments.labels.size() != arguments.motions.size()) {
    return Fail(ErrorCode::kUsage,
                Counted(static_cast<long long>(arguments.labels.size()), "file") + " of labels for " +
                    Counted(static_cast<long long>(arguments.motions.size()), "source"),
                "--labels", "give one for all, or one for each --motions in their order");
  }
  std::vector<SurveyFiles> sources;
  for (const std::string& text : arguments.motions) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      return Fail(ErrorCode::kUsage, "'" + text + "' is not NAME=FILE", "--motions",
                  "name the source of the motions, e.g. --motions Action2Motion=generated.h5");
    }
    SurveyFiles source{text.substr(0, equals), {}};
    source.files.path = text.substr(equals + 1);
    std::error_code unknown;
    if (!fs::exists(source.files.path, unknown)) {
      return Fail(ErrorCode::kNotFound, "no such file or folder", DisplayPath(source.files.path),
                  "--motions NAME=FILE names a dataset, or a file or folder of motions");
    }
    const bool ours = IsMotionStore(source.files.path);
    if (!ours) source.files.source = arguments.source;
    if (!arguments.labels.empty() && !(ours && arguments.labels.size() == 1)) {
      source.files.labels = arguments.labels[arguments.labels.size() > 1 ? sources.size() : 0];
    }
    sources.push_back(std::move(source));
  }
  return sources;
}

/// The motions of a source as one dataset or MotionSet. Motions that cannot be read are warned of.
Expected<StageInput> SourceInput(const SurveyFiles& source, const ExtractorOptions& extractor, DatasetStages& stages) {
  const MotionFiles& files = source.files;
  if (IsMotionStore(files.path) && files.labels.empty()) return StageInput{"motions", source.name, files.path, ""};
  if (files.source.empty() && AreBareArrays(files.path) && extractor.name.empty()) {
    return Fail(ErrorCode::kUsage, "bare arrays declare neither joints nor axes nor unit", DisplayPath(files.path),
                "--extractor NAME says as which recogniser's motions they are read, or --source DECLARATION");
  }
  auto motions = MakeMotionsItem(source.name, files, extractor);
  if (!motions) return Forward(motions);
  for (const RefusedClip& file : motions->unreadable) LogWarning(source.name + ": " + file.error.Message());
  const auto read = stages.One(MotionsDeclaration(), std::move(motions->item));
  if (!read) return Forward(read);
  for (const Finding& finding : read->outcome.findings) {
    LogWarning(source.name + ": " + finding.clip + ": " + finding.message);
  }
  return StageInput{"motions", source.name, read->artifact, read->sha256};
}

void PrintSurvey(const SurveyMakeArguments& arguments, const nlohmann::json& summary) {
  const nlohmann::json& key = summary.at("key");
  std::printf("%s: %s about %s of %s; send it to the participants\n", DisplayPath(arguments.output / kPageFile).c_str(),
              Counted(static_cast<long long>(key.at("questions").size()), "question").c_str(),
              Counted(static_cast<long long>(key.at("labels").size()), "label").c_str(),
              Counted(static_cast<long long>(key.at("sources").size()), "source").c_str());
  std::printf("%s: which motion stands where; keep it from them, `mocurate survey tally` needs it\n",
              DisplayPath(arguments.output / kKeyFile).c_str());
}

/// Answers that count, and why others do not.
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
                       "participant \"" + answers->participant + "\" has answered already, in " +
                           DisplayPath(first->second) + "; each counts once",
                       DisplayPath(file) + ": /participant", "leave one of the two files out, or give --skip-bad");
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

void PrintTally(const SurveyTallyArguments& arguments, const SurveyTally& tally) {
  std::printf("%s", TallyToMarkdown(tally).c_str());
  std::printf("\nalso in %s as tally.json, tally.csv, tally.md, figure.svg\n", DisplayPath(arguments.output).c_str());
}

}  // namespace

Status SurveyMakeVerb(CommonArguments& common, const SurveyMakeArguments& arguments) {
  SurveyOptions options;
  options.kind = arguments.kind == Name(SurveyKind::kPreference) ? SurveyKind::kPreference : SurveyKind::kRealOrFake;
  if (!arguments.real.empty()) options.real = arguments.real;
  if (!arguments.real.empty() && options.kind == SurveyKind::kPreference) {
    return Fail(ErrorCode::kUsage, "a preference compares sources, none of them as recordings", "--real",
                "leave --real out, or make a survey of kind real_or_fake");
  }
  options.questions = arguments.questions;
  options.seed = arguments.seed;
  options.labels = arguments.ask;
  options.seconds = arguments.seconds;
  const auto sources = FilesOfSources(arguments);
  if (!sources) return Forward(sources);
  std::vector<fs::path> inputs;
  for (const SurveyFiles& source : *sources) inputs.push_back(source.files.path);
  inputs.insert(inputs.end(), arguments.labels.begin(), arguments.labels.end());
  const fs::path page = arguments.output / kPageFile, key = arguments.output / kKeyFile;
  if (Status free = CheckOutputs({page, key}, inputs, arguments.force); !free) return free;
  ExtractorOptions extractor;
  if (!arguments.extractor.empty()) {
    auto loaded = LoadExtractor(arguments.extractor);
    if (!loaded) return Forward(loaded);
    extractor = std::move(*loaded);
  }
  auto stages = DatasetStages::Make(common);
  if (!stages) return Forward(stages);
  ItemSpec item{"survey", OptionsToJson(options), {}};
  for (const SurveyFiles& source : *sources) {
    auto input = SourceInput(source, extractor, **stages);
    if (!input) return Forward(input);
    item.inputs.push_back(std::move(*input));
  }
  const auto made = (*stages)->One(SurveyDeclaration(), std::move(item));
  if (!made) return Forward(made);
  if (Status folder = MakeFolder(arguments.output); !folder) return folder;
  if (Status copied = CopyWhole(made->artifact, page); !copied) return copied;
  const nlohmann::json& summary = made->outcome.summary;
  if (Status written = WriteFile(key, SurveyJsonText(summary.at("key"))); !written) return written;
  for (const nlohmann::json& note : summary.at("notes")) LogWarning(note.get<std::string>());
  if (common.json) {
    common.answered = true;
    std::printf("%s", SurveyJsonText({{"page", DisplayPath(page)},
                                      {"key", DisplayPath(key)},
                                      {"survey", summary.at("key").at("survey")},
                                      {"questions", summary.at("key").at("questions").size()},
                                      {"labels", summary.at("key").at("labels")},
                                      {"motions", summary.at("motions")},
                                      {"bytes", summary.at("bytes")},
                                      {"notes", summary.at("notes")}})
                          .c_str());
  } else if (!common.quiet) {
    PrintSurvey(arguments, summary);
  }
  return {};
}

Status SurveyTallyVerb(CommonArguments& common, const SurveyTallyArguments& arguments) {
  std::vector<fs::path> inputs = arguments.answers;
  inputs.push_back(arguments.key);
  const auto output = [&](const char* name) { return arguments.output / name; };
  if (Status free = CheckOutputs({output("tally.json"), output("tally.csv"), output("tally.md"), output("figure.svg")},
                                 inputs, arguments.force);
      !free) {
    return free;
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
  SurveyTally tally = TallySurvey(*key, collected.answers);
  for (const auto& [file, error] : collected.bad) {
    LogWarning("not counted: " + error.Message());
    tally.skipped.push_back({DisplayPath(file), error.Message()});
  }
  if (Status folder = MakeFolder(arguments.output); !folder) return folder;
  const std::string json = SurveyJsonText(TallyToJson(tally));
  for (const auto& [name, text] :
       {std::pair("tally.json", json), std::pair("tally.csv", TallyToCsv(tally)),
        std::pair("tally.md", TallyToMarkdown(tally)), std::pair("figure.svg", TallyToSvg(tally))}) {
    if (Status written = WriteFile(output(name), text); !written) return written;
  }
  if (common.json) {
    common.answered = true;
    std::printf("%s", json.c_str());
  } else if (!common.quiet) {
    PrintTally(arguments, tally);
  }
  return {};
}

void AddSurvey(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  CLI::App* survey = app.add_subcommand("survey", "Ask people about motions: a page of questions, a tally of answers");
  survey->require_subcommand(1);
  auto making = std::make_shared<SurveyMakeArguments>();
  CLI::App* make = survey->add_subcommand("make", "An offline page of questions, and the key to its answers");
  make->add_option("kind", making->kind,
                   "preference: which of two sources' motions looks more like the action; real_or_fake: whether a "
                   "motion was recorded")
      ->required()
      ->check(CLI::IsMember({"preference", "real_or_fake"}));
  make->add_option("--motions", making->motions,
                   "motions of a source: a dataset or MotionSet, or a file or folder as for eval; once for each source")
      ->required()
      ->type_name("NAME=FILE")
      ->allow_extra_args(false);
  make->add_option("--real", making->real, "with real_or_fake: the source that holds recordings (default: real)");
  make->add_option("--questions", making->questions, "default: all that the motions are enough for, at most 40")
      ->check(CLI::Range(1, 1000));
  make->add_option("--seed", making->seed, "of every draw: which motions, their order and sides")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{9000000000000000}))
      ->capture_default_str();
  make->add_option("--label", making->ask, "ask about this label; may be repeated (default: all that each source has)")
      ->allow_extra_args(false);
  make->add_option("--seconds", making->seconds, "of each motion, from its begin, at most")
      ->check(CLI::Range(0.1, 60.0))
      ->capture_default_str();
  make->add_option("--labels", making->labels,
                   "labels of motions that hold none, as for eval: once, or for each source")
      ->allow_extra_args(false);
  make->add_option("--source", making->source, "source declaration of files that are no datasets");
  make->add_option("--extractor", making->extractor,
                   "bare arrays have the joints, axes and unit of this recogniser: a name of configs/extractors");
  make->add_option("-o,--output", making->output, "folder for survey.html and key.json")->required();
  make->add_flag("--force", making->force, "overwrite");
  make->footer(
      "The page works without a network and names no source; it saves answers_PARTICIPANT.json (docs/surveys.md).\n\n"
      "Examples:\n"
      "  mocurate survey make preference --motions ours=ours.h5 --motions GRU=gru.h5 --questions 30 -o survey\n"
      "  mocurate survey make real_or_fake --motions real=runs/kard/dataset.h5 --motions ours=ours.h5 --label walk \\\n"
      "    --label throw --seconds 3 -o survey");
  make->callback([&common, &verb, making] { verb = [&common, making] { return SurveyMakeVerb(common, *making); }; });
  auto counting = std::make_shared<SurveyTallyArguments>();
  CLI::App* tally = survey->add_subcommand("tally", "Count answers: shares of votes with 95 % intervals, and a figure");
  tally->add_option("key", counting->key, "key.json of the survey")->required();
  tally->add_option("answers", counting->answers, "answers_PARTICIPANT.json of each participant");
  tally->add_option("-o,--output", counting->output, "folder for tally.json, tally.csv, tally.md and figure.svg")
      ->required();
  tally->add_flag("--skip-bad", counting->skip_bad,
                  "leave files out that are edited, incomplete or of another survey, and say so");
  tally->add_flag("--force", counting->force, "overwrite");
  tally->footer(
      "Examples:\n  mocurate survey tally survey/key.json answers_*.json -o tally\n"
      "  mocurate survey tally survey/key.json answers/*.json --skip-bad -o tally --force");
  tally->callback(
      [&common, &verb, counting] { verb = [&common, counting] { return SurveyTallyVerb(common, *counting); }; });
}

}  // namespace mocurate
