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
      "review",
      "A page on which a person decides about what an audit found: keep, drop, relabel, cut; or marks labelled spans");
  review->add_option("path", arguments->path, "dataset (.h5)")->required();
  review->add_option("-o,--output", arguments->output, "page (.html)")->required();
  CLI::Option* audited =
      review->add_option("--audit", arguments->audit, "audit.json of the dataset (default: it is audited now)");
  CLI::Option* decided =
      review->add_option("--decisions", arguments->decisions, "made earlier: the page begins with them");
  CLI::Option* classified =
      review->add_option("--probabilities", arguments->probabilities, "as of `mocurate audit`")->excludes(audited);
  CLI::Option* most = review->add_option("--most", arguments->most, "findings shown, the worst first")
                          ->check(CLI::Range(1, 2000))
                          ->capture_default_str();
  CLI::Option* set = review->add_option("--set", arguments->assignments, "override an option of the audit")
                         ->excludes(audited)
                         ->type_name("KEY=VALUE")
                         ->allow_extra_args(false);
  CLI::Option* annotate =
      review->add_flag("--annotate", arguments->annotate, "a page for marking labelled spans on the timeline of clips");
  for (CLI::Option* of_findings : {audited, decided, classified, most, set}) annotate->excludes(of_findings);
  CLI::Option* labels =
      review->add_option("--labels", arguments->labels, "with --annotate: labels to choose, walk,run")->needs(annotate);
  review->add_option("--recipe", arguments->recipe, "with --annotate: recipe or config whose classes are the labels")
      ->needs(annotate)
      ->excludes(labels);
  review->add_option("--spans", arguments->spans, "with --annotate: spans.csv of an earlier session")->needs(annotate);
  CLI::Option* clips = review
                           ->add_option("--clip", arguments->clips,
                                        "with --annotate: id of a clip or recording, or its end; may be repeated "
                                        "(default: clips without a label)")
                           ->needs(annotate)
                           ->allow_extra_args(false);
  review->add_flag("--all", arguments->all, "with --annotate: clips that have a label too")
      ->needs(annotate)
      ->excludes(clips);
  review->add_flag("--force", arguments->force, "overwrite");
  review->footer(
      "The page works without a network. It saves decisions.yaml, which `mocurate dataset apply` carries out on a\n"
      "dataset, and `canon.review: decisions.yaml` in a config on every run. With --annotate it saves spans.csv, by\n"
      "which `canon.trim: {rule: annotated, spans: spans.csv}` cuts.\n\n"
      "Examples:\n  mocurate review runs/kard/dataset.h5 -o review.html\n"
      "  mocurate review runs/kard/dataset.h5 --decisions decisions.yaml -o review.html --force\n"
      "  mocurate review runs/mine/dataset.h5 --annotate --labels walk,run,sit -o annotate.html\n"
      "  mocurate review runs/mine/dataset.h5 --annotate --recipe cmu8 --spans spans.csv -o annotate.html --force");
  review->callback([&common, &verb, arguments] {
    verb = [&common, arguments] {
      return arguments->annotate ? AnnotateVerb(common, *arguments) : ReviewVerb(common, *arguments);
    };
  });
}

void AddDataset(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<DatasetArguments>();
  CLI::App* dataset =
      app.add_subcommand("dataset", "Describe, compare, merge, choose from, relabel datasets; carry decisions out");
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
  CLI::App* merge = dataset->add_subcommand("merge", "Several datasets as one: clips, labels, splits, findings");
  merge->add_option("datasets", arguments->paths, "datasets (.h5) of one skeleton")->required()->expected(2, 1000);
  merge->add_option("-o,--output", arguments->output, "new dataset (.h5)")->required();
  merge->add_flag("--force", arguments->force, "overwrite");
  merge->footer(
      "A clip that several hold alike is there once; the same id with another motion or label is an error. Labels of\n"
      "the first keep their indices, new ones follow. Splits of one name are united and checked again for leaks.\n\n"
      "Examples:\n  mocurate dataset merge runs/kard/dataset.h5 runs/florence/dataset.h5 -o both.h5\n"
      "  mocurate dataset merge a.h5 b.h5 c.h5 -o all.h5 --json");
  merge->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return DatasetMergeVerb(common, *arguments); }; });
  CLI::App* subset = dataset->add_subcommand("subset", "The clips of a dataset that a condition holds for");
  subset->add_option("dataset", arguments->path, "dataset (.h5)")->required();
  subset->add_option("--where", arguments->where, "condition about a clip")->required()->type_name("CONDITION");
  subset->add_option("-o,--output", arguments->output, "new dataset (.h5)")->required();
  subset->add_flag("--drop-empty-labels", arguments->drop_empty_labels,
                   "classes without a clip leave, and the indices of the others close up");
  subset->add_flag("--force", arguments->force, "overwrite");
  subset->footer(
      "Fields: id label fine_label person recording session view source role licence part('SPLIT') provenance('KEY'),\n"
      "numbers: frames seconds rate fit_rms findings('CODE') segments('LABEL'). Compared by == != < <= > >= =~ "
      "(regex)\n"
      "in [..] not in [..], joined by and or not ( ) (docs/datasets.md). Splits keep their parts.\n\n"
      "Examples:\n"
      "  mocurate dataset subset kard.h5 --where 'label in [walk, run] and frames >= 60 and person != P12' -o two.h5\n"
      "  mocurate dataset subset kard.h5 --where \"part('cross_subject') == test\" -o test.h5\n"
      "  mocurate dataset subset kard.h5 --where \"findings('teleport') == 0\" -o calm.h5 --drop-empty-labels");
  subset->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return DatasetSubsetVerb(common, *arguments); }; });
  CLI::App* relabel =
      dataset->add_subcommand("relabel", "A dataset with other labels: renamed, merged, ordered, dropped");
  relabel->add_option("dataset", arguments->path, "dataset (.h5)")->required();
  relabel->add_option("map", arguments->other, "YAML: old: new; or labels, classes, drop, rules, clips")->required();
  relabel->add_option("-o,--output", arguments->output, "new dataset (.h5)")->required();
  relabel->add_flag("--force", arguments->force, "overwrite");
  relabel->footer(
      "Labels of segments change too. Where the map lists no classes, the class of a new label stands where the first\n"
      "old label of it stood (docs/datasets.md).\n\n"
      "Example:\n  mocurate dataset relabel kard.h5 map.yaml -o renamed.h5");
  relabel->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return DatasetRelabelVerb(common, *arguments); }; });
}

}  // namespace mocurate
