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
  audit->add_option("--set", arguments->assignments, "override an option, e.g. --set labels.own_share=0.1")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  audit->add_flag("--force", arguments->force, "overwrite");
  audit->footer(
      "The dataset is not changed. Codes: label_suspect, duplicate, leak, split_leak, mirrored, frozen_frames,\n"
      "swapped_sides, class_not_trained, names_alike; severity info: fits_no_class, outlier.\n\n"
      "Examples:\n  mocurate audit runs/kard/dataset.h5\n  mocurate audit runs/kard/dataset.h5 --json\n"
      "  mocurate audit runs/kard/dataset.h5 -o audits/kard --fail-on error\n"
      "  mocurate audit runs/kard/dataset.h5 --fix safe.yaml\n"
      "  mocurate audit runs/kard/dataset.h5 --review decisions.yaml --fail-on warning");
  audit->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return AuditVerb(common, *arguments); }; });
}

}  // namespace mocurate
