#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace mocurate {

void AddRig(CLI::App& app, CommonArguments& common, std::function<Status()>& verb) {
  CLI::App* rig = app.add_subcommand("rig", "Audit a rig of keypoint cameras, and write it as a file for other takes");
  rig->require_subcommand(1);
  auto arguments = std::make_shared<RigAuditArguments>();
  CLI::App* audit = rig->add_subcommand("audit", "Audit the rig of all takes of a config together");
  audit->add_option("config", arguments->config, "YAML file, or the name of a job, as for run")->required();
  audit->add_option("-o,--output", arguments->output, "file of the audited rig (YAML)")->required();
  audit
      ->add_option(
          "--clip", arguments->clips,
          "take to audit: its clip id (source/person/recording), recording or file; may be repeated (default: all)")
      ->allow_extra_args(false);
  audit->add_option("--set", arguments->assignments, "override an option, e.g. --set ingest.path=DIR")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  audit->add_option("-j,--jobs", arguments->jobs, "worker processes (default: one per core)")
      ->check(CLI::Range(0, 1024));
  audit->add_flag("--force", arguments->force, "overwrite the output");
  audit->footer(
      "Poses, clocks, files, mirrored images and exchanged sides are corrected as fitting.keypoints.audit says.\n"
      "Takes use the file with fitting.keypoints.rig: rig.yaml; then their own audit only reports. With one take,\n"
      "a confidence measures repeatability within that take; with several it is from the variation between them.\n\n"
      "Examples:\n  mocurate rig audit reannotate/pose2sim_both -o rig.yaml\n"
      "  mocurate rig audit my.yaml --clip take_01 --clip take_02 -o rig.yaml\n"
      "  mocurate run my.yaml --set fitting.keypoints.rig=rig.yaml");
  audit->callback(
      [&common, &verb, arguments] { verb = [&common, arguments] { return RigAuditVerb(common, *arguments); }; });
}

}  // namespace mocurate
