#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace mocurate {

void AddDataset(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  auto arguments = std::make_shared<DatasetArguments>();
  CLI::App* dataset =
      app.add_subcommand("dataset", "Describe, compare, merge, filter, relabel datasets; apply decisions");
  dataset->require_subcommand(1);
  CLI::App* card = dataset->add_subcommand("card", "A README for a dataset: counts, classes, splits, licences, hashes");
  card->add_option("path", arguments->path, "dataset (.h5)")->required();
  card->add_flag("--croissant", arguments->croissant, "as Croissant (JSON-LD) instead of Markdown");
  card->add_option("-o,--output", arguments->output, "file (default: stdout)");
  card->add_flag("--force", arguments->force, "overwrite");
  card->footer(
      "Examples:\n  mocurate dataset card runs/kard/dataset.h5 -o README.md\n"
      "  mocurate dataset card runs/kard/dataset.h5 --croissant -o croissant.json");
  card->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return DatasetCardVerb(common, *arguments); }; });
  CLI::App* diff = dataset->add_subcommand(
      "diff", "Clips added, removed, relabelled, moved between parts, or refitted (with distances)");
  diff->add_option("before", arguments->path, "dataset (.h5)")->required();
  diff->add_option("after", arguments->other, "dataset (.h5)")->required();
  diff->footer("Example:\n  mocurate dataset diff runs/old/dataset.h5 runs/new/dataset.h5 --json");
  diff->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return DatasetDiffVerb(common, *arguments); }; });
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
  apply->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return DatasetApplyVerb(common, *arguments); }; });
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
  merge->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return DatasetMergeVerb(common, *arguments); }; });
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
  subset->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return DatasetSubsetVerb(common, *arguments); }; });
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
  relabel->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return DatasetRelabelVerb(common, *arguments); }; });
}

}  // namespace mocurate
