// Verbs about datasets: audit, review, survey, dataset.

#include <cstdint>

#include "app/commands.h"

namespace mocurate {
namespace {

void AddAudit(const CommandLine& line) {
  auto arguments = std::make_shared<AuditArguments>();
  CLI::App* audit = line.app.add_subcommand(
      "audit", "Look for errors in a dataset: labels, leaks, duplicates, mirrored, swapped and frozen clips");
  audit->add_option("path", arguments->path, "dataset (.h5)")->required();
  audit->add_option(
      "--probabilities", arguments->probabilities,
      "class probabilities of its clips from a classifier that was not trained on them, instead of the built-in "
      "one: features/SET.h5 of `mocurate eval -o`");
  audit->add_option("--fail-on", arguments->fail_on, "exit code 1 for findings of at least this severity")
      ->check(CLI::IsMember({"warning", "error"}));
  audit->add_option(
      "-o,--output", arguments->output,
      "folder for audit.json, clips.csv (measures of all clips) and audit.html (page of the worst twenty)");
  audit->add_option("--review", arguments->review,
                    "decisions.yaml of `mocurate review`: findings with the decision keep are not reported again");
  audit->add_option("--with-findings", arguments->with_findings,
                    "file for a copy of the dataset with the findings in /findings");
  audit->add_option("--fix", arguments->fixes,
                    "file for safe decisions, which drop exact repeats of another clip; "
                    "`mocurate dataset apply` or canon.review applies them");
  AddAssignments(audit, arguments->assignments, "override an option, e.g. --set labels.own_share=0.1");
  audit->add_flag("--force", arguments->force, "overwrite");
  audit->footer(
      "The dataset is not changed. Codes: label_suspect, duplicate, leak, split_leak, mirrored, frozen_frames,\n"
      "swapped_sides, class_not_trained, names_alike; severity info: fits_no_class, outlier.\n\n"
      "Examples:\n  mocurate audit runs/kard/dataset.h5\n  mocurate audit runs/kard/dataset.h5 --json\n"
      "  mocurate audit runs/kard/dataset.h5 -o audits/kard --fail-on error\n"
      "  mocurate audit runs/kard/dataset.h5 --fix safe.yaml\n"
      "  mocurate audit runs/kard/dataset.h5 --review decisions.yaml --fail-on warning");
  line.Calls(audit, AuditVerb, arguments);
}

void AddReview(const CommandLine& line) {
  auto arguments = std::make_shared<ReviewArguments>();
  CLI::App* review = line.app.add_subcommand(
      "review", "A page to decide about findings of an audit (keep, drop, relabel, cut), or to mark labelled spans");
  review->add_option("path", arguments->path, "dataset (.h5)")->required();
  review->add_option("-o,--output", arguments->output, "page (.html)")->required();
  CLI::Option* audited =
      review->add_option("--audit", arguments->audit, "audit.json of the dataset (default: run the audit)");
  CLI::Option* decided =
      review->add_option("--decisions", arguments->decisions, "decisions.yaml of an earlier session, to start from");
  CLI::Option* classified =
      review->add_option("--probabilities", arguments->probabilities, "as for `mocurate audit`")->excludes(audited);
  CLI::Option* most = review->add_option("--most", arguments->most, "number of findings shown, the worst first")
                          ->check(CLI::Range(1, 2000))
                          ->capture_default_str();
  CLI::Option* set =
      AddAssignments(review, arguments->assignments, "override an option of the audit")->excludes(audited);
  CLI::Option* annotate =
      review->add_flag("--annotate", arguments->annotate, "a page for marking labelled spans on the timeline of clips");
  for (CLI::Option* of_findings : {audited, decided, classified, most, set}) annotate->excludes(of_findings);
  CLI::Option* labels =
      review->add_option("--labels", arguments->labels, "with --annotate: labels to choose from, e.g. walk,run")
          ->needs(annotate);
  review->add_option("--recipe", arguments->recipe, "with --annotate: recipe or config whose classes are the labels")
      ->needs(annotate)
      ->excludes(labels);
  review->add_option("--spans", arguments->spans, "with --annotate: spans.csv of an earlier session")->needs(annotate);
  CLI::Option* clips = AddRepeated(review, "--clip", arguments->clips,
                                   "with --annotate: id of a clip or recording, in full or its last part; may be "
                                   "repeated (default: clips without a label)")
                           ->needs(annotate);
  review->add_flag("--all", arguments->all, "with --annotate: show labelled clips as well")
      ->needs(annotate)
      ->excludes(clips);
  review->add_flag("--force", arguments->force, "overwrite");
  review->footer(
      "The page works without a network. It saves decisions.yaml. `mocurate dataset apply` applies it to a dataset,\n"
      "`canon.review: decisions.yaml` in a config applies it in every run. With --annotate it saves spans.csv, by\n"
      "which `canon.trim: {rule: annotated, spans: spans.csv}` cuts.\n\n"
      "Examples:\n  mocurate review runs/kard/dataset.h5 -o review.html\n"
      "  mocurate review runs/kard/dataset.h5 --decisions decisions.yaml -o review.html --force\n"
      "  mocurate review runs/mine/dataset.h5 --annotate --labels walk,run,sit -o annotate.html\n"
      "  mocurate review runs/mine/dataset.h5 --annotate --recipe cmu8 --spans spans.csv -o annotate.html --force");
  const auto call = [](CommonArguments& common, const ReviewArguments& given) {
    return given.annotate ? AnnotateVerb(common, given) : ReviewVerb(common, given);
  };
  line.Calls(review, call, arguments);
}

void AddSurvey(const CommandLine& line) {
  CLI::App* survey =
      line.app.add_subcommand("survey", "Ask people about motions: a page of questions, a tally of answers");
  survey->require_subcommand(1);
  auto making = std::make_shared<SurveyMakeArguments>();
  CLI::App* make = survey->add_subcommand("make", "An offline page of questions, and the key to its answers");
  make->add_option(
          "kind", making->kind,
          "ranking: one motion of each source (2 to 9) is ranked by quality and fit to the label; real_or_fake: "
          "each motion of a page is judged as recorded or generated")
      ->required()
      ->check(CLI::IsMember({"ranking", "real_or_fake"}));
  AddRepeated(make, "--motions", making->motions,
              "motions of a source: a dataset or MotionSet, or a file or folder as for eval; once per source")
      ->required()
      ->type_name("NAME=FILE");
  make->add_option("--real", making->real, "with real_or_fake: the source of recordings (default: real)");
  make->add_option("--questions", making->questions,
                   "number of pages (default: ranking: one for each label, at most 40; real_or_fake: 12)")
      ->check(CLI::Range(1, 1000));
  make->add_option("--clips", making->clips, "with real_or_fake: motions of a page (default: 6)")
      ->check(CLI::Range(1, 9));
  make->add_option("--figure", making->figure,
                   "draw a skinned body or bones (default: skin with real_or_fake or --body, else bones)")
      ->check(CLI::IsMember({"skin", "bones"}));
  make->add_option(
      "--body", making->body,
      "body of the skin: SMPL_NEUTRAL.pkl, body_cc0.h5 (default: below MOCURATE_WEIGHTS or MOCURATE_DATA)");
  make->add_option("--seed", making->seed, "seed of all draws: motions, their order, places and windows")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{9000000000000000}))
      ->capture_default_str();
  AddRepeated(make, "--label", making->ask,
              "ask about this label; may be repeated (default: all labels that every source has)");
  make->add_option("--seconds", making->seconds,
                   "shown seconds of each motion at most; all of a page last as long as its shortest")
      ->check(CLI::Range(0.1, 60.0))
      ->capture_default_str();
  AddRepeated(make, "--labels", making->labels,
              "labels of motions without labels, as for eval: once, or for each source");
  make->add_option("--source", making->source, "source declaration of files that are not datasets");
  make->add_option("--extractor", making->extractor,
                   "recogniser whose joints, axes and unit bare arrays have: a name of configs/extractors");
  make->add_option("-o,--output", making->output, "folder for survey.html and key.json")->required();
  make->add_flag("--force", making->force, "overwrite");
  make->footer(
      "The page works without a network and names no source; it saves answers_PARTICIPANT.json (docs/surveys.md).\n\n"
      "Examples:\n"
      "  mocurate survey make ranking --motions real=runs/humanact12/dataset.h5 --motions ours=ours.h5 \\\n"
      "    --motions GRU=gru.h5 -o survey\n"
      "  mocurate survey make real_or_fake --motions real=smpl.h5 --motions ours=ours_smpl.h5 --seconds 3 -o survey\n"
      "  mocurate survey make real_or_fake --motions real=runs/kard/dataset.h5 --motions ours=ours.h5 --label walk \\\n"
      "    --questions 2 --clips 4 --figure bones -o survey");
  line.Calls(make, SurveyMakeVerb, making);
  auto counting = std::make_shared<SurveyTallyArguments>();
  CLI::App* tally =
      survey->add_subcommand("tally", "Count answers: shares with 95 % intervals, tests of differences, a figure");
  tally->add_option("key", counting->key, "key.json of the survey")->required();
  tally->add_option("answers", counting->answers, "answers_PARTICIPANT.json of each participant");
  tally
      ->add_option("-o,--output", counting->output,
                   "folder for tally.json, tally.csv, differences.csv, tally.md and figure.svg")
      ->required();
  tally->add_flag("--skip-bad", counting->skip_bad,
                  "skip files that are edited, incomplete or from another survey, with a warning");
  tally->add_flag("--force", counting->force, "overwrite");
  tally->footer(
      "Examples:\n  mocurate survey tally survey/key.json answers_*.json -o tally\n"
      "  mocurate survey tally survey/key.json answers/*.json --skip-bad -o tally --force");
  line.Calls(tally, SurveyTallyVerb, counting);
}

void AddDataset(const CommandLine& line) {
  auto arguments = std::make_shared<DatasetArguments>();
  CLI::App* dataset =
      line.app.add_subcommand("dataset", "Describe, compare, merge, filter, relabel datasets; apply decisions");
  dataset->require_subcommand(1);
  CLI::App* card = dataset->add_subcommand("card", "A README for a dataset: counts, classes, splits, licences, hashes");
  card->add_option("path", arguments->path, "dataset (.h5)")->required();
  card->add_flag("--croissant", arguments->croissant, "as Croissant (JSON-LD) instead of Markdown");
  card->add_option("-o,--output", arguments->output, "file (default: stdout)");
  card->add_flag("--force", arguments->force, "overwrite");
  card->footer(
      "Examples:\n  mocurate dataset card runs/kard/dataset.h5 -o README.md\n"
      "  mocurate dataset card runs/kard/dataset.h5 --croissant -o croissant.json");
  line.Calls(card, DatasetCardVerb, arguments);
  CLI::App* diff = dataset->add_subcommand(
      "diff", "Clips added, removed, relabelled, moved between parts, or refitted (with distances)");
  diff->add_option("before", arguments->path, "dataset (.h5)")->required();
  diff->add_option("after", arguments->other, "dataset (.h5)")->required();
  diff->footer("Example:\n  mocurate dataset diff runs/old/dataset.h5 runs/new/dataset.h5 --json");
  line.Calls(diff, DatasetDiffVerb, arguments);
  CLI::App* apply = dataset->add_subcommand("apply", "Apply decisions: a new dataset without the dropped clips");
  apply->add_option("dataset", arguments->path, "dataset (.h5)")->required();
  apply->add_option("decisions", arguments->other, "decisions.yaml of `mocurate review`")->required();
  apply->add_option("-o,--output", arguments->output, "new dataset (.h5)")->required();
  apply->add_option("--excluded", arguments->excluded, "file for the dropped clips, as another dataset");
  apply->add_flag("--force", arguments->force, "overwrite");
  apply->footer(
      "Splits keep their parts. Decisions about clips that are missing or have changed are reported and not "
      "applied.\n\n"
      "Example:\n  mocurate dataset apply runs/kard/dataset.h5 decisions.yaml -o clean.h5 --excluded dropped.h5");
  line.Calls(apply, DatasetApplyVerb, arguments);
  CLI::App* merge = dataset->add_subcommand("merge", "Merge datasets: clips, labels, splits, findings");
  merge->add_option("datasets", arguments->paths, "datasets (.h5) of one skeleton")->required()->expected(2, 1000);
  merge->add_option("-o,--output", arguments->output, "new dataset (.h5)")->required();
  merge->add_flag("--force", arguments->force, "overwrite");
  merge->footer(
      "A clip that several contain alike is written once; the same id with another motion or label is an error. Labels "
      "of\n"
      "the first keep their indices, new ones follow. Splits of equal names are united and checked for leaks.\n\n"
      "Examples:\n  mocurate dataset merge runs/kard/dataset.h5 runs/florence/dataset.h5 -o both.h5\n"
      "  mocurate dataset merge a.h5 b.h5 c.h5 -o all.h5 --json");
  line.Calls(merge, DatasetMergeVerb, arguments);
  CLI::App* subset = dataset->add_subcommand("subset", "The clips of a dataset that meet a condition");
  subset->add_option("dataset", arguments->path, "dataset (.h5)")->required();
  subset->add_option("--where", arguments->where, "condition on a clip's fields")->required()->type_name("CONDITION");
  subset->add_option("-o,--output", arguments->output, "new dataset (.h5)")->required();
  subset->add_flag("--drop-empty-labels", arguments->drop_empty_labels,
                   "remove classes without a clip and renumber the others");
  subset->add_flag("--force", arguments->force, "overwrite");
  subset->footer(
      "Fields: id label fine_label person recording session view source role licence part('SPLIT') provenance('KEY'),\n"
      "numbers: frames seconds rate fit_rms findings('CODE') segments('LABEL'). Compared by == != < <= > >= =~ "
      "(regex)\n"
      "in [..] not in [..], joined by and or not ( ) (docs/datasets.md). Splits keep their parts.\n\n"
      "Examples:\n"
      "  mocurate dataset subset kard.h5 --where 'label in [walk, run] and frames >= 60 and person != P12' -o two.h5\n"
      "  mocurate dataset subset kard.h5 --where \"part('cross_subject') == test\" -o test.h5\n"
      "  mocurate dataset subset kard.h5 --where \"findings('position_jump') == 0\" -o calm.h5 --drop-empty-labels");
  line.Calls(subset, DatasetSubsetVerb, arguments);
  CLI::App* relabel =
      dataset->add_subcommand("relabel", "A dataset with other labels: renamed, merged, ordered, dropped");
  relabel->add_option("dataset", arguments->path, "dataset (.h5)")->required();
  relabel->add_option("map", arguments->other, "YAML: old: new; or labels, classes, drop, rules, clips")->required();
  relabel->add_option("-o,--output", arguments->output, "new dataset (.h5)")->required();
  relabel->add_flag("--force", arguments->force, "overwrite");
  relabel->footer(
      "Labels of segments change too. Without a list of classes in the map, a new label has the index of its first\n"
      "old label (docs/datasets.md).\n\n"
      "Example:\n  mocurate dataset relabel kard.h5 map.yaml -o renamed.h5");
  line.Calls(relabel, DatasetRelabelVerb, arguments);
}

}  // namespace

void AddDatasetVerbs(const CommandLine& line) {
  for (const auto add : {AddAudit, AddReview, AddSurvey, AddDataset}) add(line);
}

}  // namespace mocurate
