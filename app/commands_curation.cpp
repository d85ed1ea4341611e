// The command lines of the verbs that look after datasets.

#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace mocurate {

void AddAudit(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<AuditArguments>();
  CLI::App* audit = app.add_subcommand(
      "audit", "Look for errors in a dataset: labels, leaks, duplicates, mirrored, swapped and frozen clips");
  audit->add_option("path", arguments->path, "dataset (.h5)")->required();
  audit->add_option(
      "--probabilities", arguments->probabilities,
      "classes of its clips by another classifier that did not learn from them, in the place of the plain "
      "one: features/SET.h5 of `mocurate eval -o`");
  audit->add_option("--fail-on", arguments->fail_on, "exit code 1 where a finding is of this severity or worse")
      ->check(CLI::IsMember({"warning", "error"}));
  audit->add_option(
      "-o,--output", arguments->output,
      "folder for audit.json, clips.csv with the measures of all clips, and audit.html, a page of the worst twenty");
  audit->add_option(
      "--review", arguments->review,
      "decisions (decisions.yaml of `mocurate review`): findings that a person kept are not reported again");
  audit->add_option("--with-findings", arguments->with_findings,
                    "file for the dataset with what was found in /findings; the dataset itself is not touched");
  audit->add_option("--fix", arguments->fixes,
                    "file for decisions that are safe, to drop what repeats another clip without any difference; "
                    "`mocurate dataset apply` or canon.review carries them out");
  audit->add_option("--set", arguments->assignments, "override an option, e.g. --set labels.own_share=0.1")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  audit->add_flag("--force", arguments->force, "overwrite");
  audit->footer(
      "Nothing is changed. Codes: label_suspect, duplicate, leak, mirrored, frozen_frames, swapped_sides,\n"
      "class_not_trained, names_alike; for information: fits_no_class, outlier.\n\n"
      "Examples:\n  mocurate audit runs/kard/dataset.h5\n  mocurate audit runs/kard/dataset.h5 --json\n"
      "  mocurate audit runs/kard/dataset.h5 -o audits/kard --fail-on error\n"
      "  mocurate audit runs/kard/dataset.h5 --fix safe.yaml\n"
      "  mocurate audit runs/kard/dataset.h5 --review decisions.yaml --fail-on warning");
  audit->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return AuditVerb(common, *arguments); }; });
}

void AddReview(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<ReviewArguments>();
  CLI::App* review = app.add_subcommand(
      "review", "A page on which a person decides about what an audit found: keep, drop, relabel, cut");
  review->add_option("path", arguments->path, "dataset (.h5)")->required();
  review->add_option("-o,--output", arguments->output, "page (.html)")->required();
  CLI::Option* audited =
      review->add_option("--audit", arguments->audit, "audit.json of the dataset (default: it is audited now)");
  review->add_option("--decisions", arguments->decisions, "made earlier: the page begins with them");
  review->add_option("--probabilities", arguments->probabilities, "as of `mocurate audit`")->excludes(audited);
  review->add_option("--most", arguments->most, "findings shown, the worst first")
      ->check(CLI::Range(1, 2000))
      ->capture_default_str();
  review->add_option("--set", arguments->assignments, "override an option of the audit")
      ->excludes(audited)
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  review->add_flag("--force", arguments->force, "overwrite");
  review->footer(
      "The page works without a network. It saves decisions.yaml, which `mocurate dataset apply` carries out on a\n"
      "dataset, and `canon.review: decisions.yaml` in a config on every run.\n\n"
      "Examples:\n  mocurate review runs/kard/dataset.h5 -o review.html\n"
      "  mocurate review runs/kard/dataset.h5 --decisions decisions.yaml -o review.html --force");
  review->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return ReviewVerb(common, *arguments); }; });
}

void AddDataset(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<DatasetArguments>();
  CLI::App* dataset = app.add_subcommand("dataset", "Describe a dataset, compare two, apply decisions to one");
  dataset->require_subcommand(1);
  CLI::App* card = dataset->add_subcommand("card", "A README for a dataset: counts, classes, splits, licences, hashes");
  card->add_option("path", arguments->path, "dataset (.h5)")->required();
  card->add_flag("--croissant", arguments->croissant, "as Croissant (JSON-LD) in the place of Markdown");
  card->add_option("-o,--output", arguments->output, "file (default: stdout)");
  card->add_flag("--force", arguments->force, "overwrite");
  card->footer(
      "Examples:\n  mocurate dataset card runs/kard/dataset.h5 -o README.md\n"
      "  mocurate dataset card runs/kard/dataset.h5 --croissant -o croissant.json");
  card->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return DatasetCardVerb(common, *arguments); }; });
  CLI::App* diff = dataset->add_subcommand(
      "diff", "Clips added, removed, relabelled, moved between parts, refitted and by how much");
  diff->add_option("before", arguments->path, "dataset (.h5)")->required();
  diff->add_option("after", arguments->other, "dataset (.h5)")->required();
  diff->footer("Example:\n  mocurate dataset diff runs/old/dataset.h5 runs/new/dataset.h5 --json");
  diff->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return DatasetDiffVerb(common, *arguments); }; });
  CLI::App* apply =
      dataset->add_subcommand("apply", "Carry decisions out: a new dataset without what a person dropped");
  apply->add_option("dataset", arguments->path, "dataset (.h5)")->required();
  apply->add_option("decisions", arguments->other, "decisions.yaml of `mocurate review`")->required();
  apply->add_option("-o,--output", arguments->output, "new dataset (.h5)")->required();
  apply->add_option("--excluded", arguments->excluded, "file for the clips that are dropped, a dataset of its own");
  apply->add_flag("--force", arguments->force, "overwrite");
  apply->footer(
      "Splits keep their parts. Decisions about clips that are gone or have changed are reported and not carried "
      "out.\n\n"
      "Example:\n  mocurate dataset apply runs/kard/dataset.h5 decisions.yaml -o clean.h5 --excluded dropped.h5");
  apply->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return DatasetApplyVerb(common, *arguments); }; });
}

}  // namespace mocurate
