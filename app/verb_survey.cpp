#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>

#include "app/commands.h"

namespace mocurate {

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
                   "motions of a source: a dataset or MotionSet, or a file or folder as for eval; once per source")
      ->required()
      ->type_name("NAME=FILE")
      ->allow_extra_args(false);
  make->add_option("--real", making->real, "with real_or_fake: the source of recordings (default: real)");
  make->add_option("--questions", making->questions,
                   "number of questions (default: as many as possible with the motions, at most 40)")
      ->check(CLI::Range(1, 1000));
  make->add_option("--seed", making->seed, "seed of all draws: motions, their order and sides")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{9000000000000000}))
      ->capture_default_str();
  make->add_option("--label", making->ask,
                   "ask about this label; may be repeated (default: all labels that every source has)")
      ->allow_extra_args(false);
  make->add_option("--seconds", making->seconds, "shown seconds of each motion, from its begin, at most")
      ->check(CLI::Range(0.1, 60.0))
      ->capture_default_str();
  make->add_option("--labels", making->labels,
                   "labels of motions without labels, as for eval: once, or for each source")
      ->allow_extra_args(false);
  make->add_option("--source", making->source, "source declaration of files that are not datasets");
  make->add_option("--extractor", making->extractor,
                   "recogniser whose joints, axes and unit bare arrays have: a name of configs/extractors");
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
                  "skip files that are edited, incomplete or from another survey, with a warning");
  tally->add_flag("--force", counting->force, "overwrite");
  tally->footer(
      "Examples:\n  mocurate survey tally survey/key.json answers_*.json -o tally\n"
      "  mocurate survey tally survey/key.json answers/*.json --skip-bad -o tally --force");
  tally->callback(
      [&common, &verb, counting] { verb = [&common, counting] { return SurveyTallyVerb(common, *counting); }; });
}

}  // namespace mocurate
