#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace mocurate {

void AddReview(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<ReviewArguments>();
  CLI::App* review = app.add_subcommand(
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
  CLI::Option* set = review->add_option("--set", arguments->assignments, "override an option of the audit")
                         ->excludes(audited)
                         ->type_name("KEY=VALUE")
                         ->allow_extra_args(false);
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
  CLI::Option* clips = review
                           ->add_option("--clip", arguments->clips,
                                        "with --annotate: id of a clip or recording, in full or its last part; may be "
                                        "repeated (default: clips without a label)")
                           ->needs(annotate)
                           ->allow_extra_args(false);
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
  review->callback([&common, &verb, arguments] {
    verb = [&common, arguments] {
      return arguments->annotate ? AnnotateVerb(common, *arguments) : ReviewVerb(common, *arguments);
    };
  });
}

}  // namespace mocurate
