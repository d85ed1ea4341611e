// Verbs that run stages: run, plan, jobs, fit, rig.

#include "app/commands.h"

namespace mocurate {
namespace {

void AddRun(const CommandLine& line) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* run =
      line.app.add_subcommand("run", "Run a job: ingest, fit, canonicalise, assemble, train, score, report");
  auto* config = run->add_option(
      "config", arguments->config,
      "YAML file, or the name of a job of configs (kard, reannotate/kard); a job precedes a file of that name "
      "(./NAME). Default: the embedded synthetic capture");
  auto* output = run->add_option("-o,--output", arguments->output, "run folder (default runs/NAME)");
  auto* set = AddAssignments(run, arguments->assignments, "override an option, e.g. --set ingest.path=DIR");
  auto* to = run->add_option("--to", arguments->to,
                             "last stage: ingest proportions fitting canon assemble audit train table report");
  AddJobCount(run, arguments->jobs);
  auto* budget =
      run->add_option("--budget", arguments->budget, "train the generator this many times longer than the config says")
          ->check(CLI::Range(0.001, 1e6));
  auto* data = AddRepeated(run, "--data", arguments->data,
                           "NAME=PATH: your copy of a set, in a run over several; may be repeated");
  auto* dry_run =
      run->add_flag("-n,--dry-run", arguments->dry_run, "show what would run and what the cache has, run nothing");
  auto* executor = run->add_option("--executor", arguments->executor,
                                   "local, or slurm: stages with an item per clip are arrays of Slurm (the config's "
                                   "`executor`; options of the jobs: its group `slurm`)")
                       ->check(CLI::IsMember({"local", "slurm"}));
  auto* no_wait = run->add_flag("--no-wait", arguments->no_wait,
                                "with Slurm: end when the first job is submitted; see mocurate jobs");
  auto* replace = run->add_flag("--replace", arguments->replace,
                                "use the folder of another job or configuration file; its outputs stay, marked as "
                                "stale, until this job writes its own");
  auto* plan = run->add_option("--plan", arguments->plan, "run one task of a plan (mocurate plan) instead");
  for (CLI::Option* other : {config, output, set, to, budget, data, dry_run, executor, no_wait, replace})
    plan->excludes(other);
  run->add_option("--task", arguments->task, "which task of the plan, from 0")->needs(plan);
  run->add_option("--scratch", arguments->scratch,
                  "folder on a disk of this node for outputs until they are complete (default: in the cache)")
      ->needs(plan);
  run->footer(
      "Examples:\n  mocurate run\n  mocurate run kard -o runs/kard\n"
      "  mocurate run kard --set ingest.path=/data/my_kinect --to assemble\n  mocurate run my.yaml\n"
      "  mocurate run reannotate/kard --set report.videos=false   # videos can take longer than the fits\n"
      "  mocurate run kard -o /shared/runs/kard --executor slurm --set slurm.partition=short --set slurm.memory='4 "
      "GB'");
  const auto call = [](CommonArguments& common, const RunArguments& given) {
    return given.plan.empty() ? RunVerb(common, given) : TaskVerb(common, given);
  };
  line.Calls(run, call, arguments);
}

void AddPlan(const CommandLine& line) {
  auto arguments = std::make_shared<PlanArguments>();
  CLI::App* plan = line.app.add_subcommand("plan", "Cut the missing items of a stage into tasks for several machines");
  plan->add_option("config", arguments->config, "YAML file, or the name of a job, as of mocurate run");
  plan->add_option("--stage", arguments->stage,
                   "ingest, truth, proportions, fitting, level or canon; earlier ones are done")
      ->required();
  plan->add_option("-o,--output", arguments->output,
                   "run folder (default runs/NAME); the plan is plan/STAGE.json there");
  AddAssignments(plan, arguments->assignments, "override an option, e.g. --set ingest.path=DIR");
  auto* tasks = plan->add_option("--tasks", arguments->tasks, "number of tasks, at most; fewer items give fewer tasks")
                    ->check(CLI::Range(std::size_t{1}, std::size_t{1000000}));
  plan->add_option("--task-minutes", arguments->task_minutes,
                   "minutes of a task (default 10), by the times of items in the journals of the run; without any, 32 "
                   "items are executed first")
      ->check(CLI::Range(0.01, 1e5))
      ->excludes(tasks);
  plan->add_option(
          "--leftovers", arguments->leftovers,
          "missing items of each earlier stage that are executed here, at most (default 32); more are an error")
      ->check(CLI::Range(std::size_t{0}, std::size_t{1000000}));
  plan->add_option("--cores", arguments->cores, "cores of a task (default 1)")->check(CLI::Range(1, 1024));
  AddJobCount(plan, arguments->jobs, "worker processes for items executed here (default: one per core)");
  plan->add_flag("--replace", arguments->replace, "use the folder of another job, as of mocurate run");
  plan->footer(
      "Examples:\n  mocurate plan kard --stage ingest --tasks 8 -o runs/kard\n"
      "  mocurate run --plan runs/kard/plan/ingest.json --task 0   # ... to 7, on any machine that shares the cache\n"
      "  mocurate plan kard --stage proportions -o runs/kard       # the next stage, when all have ended\n"
      "  mocurate run kard -o runs/kard                            # in the end: takes their results from the cache");
  line.Calls(plan, PlanVerb, arguments);
}

void AddJobs(const CommandLine& line) {
  auto arguments = std::make_shared<JobsArguments>();
  CLI::App* jobs = line.app.add_subcommand("jobs", "Show how the tasks of a run on Slurm do");
  jobs->add_option("run", arguments->run, "run folder of mocurate run --executor slurm")->required();
  auto* next = jobs->add_flag("--next", arguments->next,
                              "verify what the last array made, plan the next stage and submit it; jobs do this");
  auto* last = jobs->add_flag("--last", arguments->last, "do the stages after the arrays here; the last job does this")
                   ->excludes(next);
  auto* config = jobs->add_option("--config", arguments->config,
                                  "configuration of the run, for --next and --last: what they execute is never taken "
                                  "from the folder");
  AddAssignments(jobs, arguments->assignments, "its assignments, as given to mocurate run")->needs(config);
  next->needs(config);
  last->needs(config);
  jobs->footer(
      "Reads the files of the run; asks squeue at most once a minute and sacct never.\n"
      "Examples:\n  mocurate jobs runs/kard\n  mocurate jobs runs/kard --json\n"
      "  mocurate jobs runs/kard --next --config kard   # when the job between two stages was lost");
  line.Calls(jobs, JobsVerb, arguments);
}

void AddFit(const CommandLine& line) {
  auto arguments = std::make_shared<FitArguments>();
  CLI::App* fit = line.app.add_subcommand("fit", "Fit skeleton rotations to captures or motions, without a config");
  fit->add_option("path", arguments->path, "file or folder: captures, or a dataset or MotionSet")->required();
  fit->add_option("-o,--output", arguments->output, "dataset to write (HDF5)")->required();
  fit->add_option("--skeleton", arguments->skeleton,
                  "skeleton of the fitted motion (default: one with the tracked joints; recorded rotations are kept)");
  fit->add_option("--source", arguments->source,
                  "name of a source declaration of configs/sources (precedes a file of that name), or a config");
  AddRepeated(fit, "--clip", arguments->clips,
              "clip to fit, as named by `inspect`: a file, '[3]' in a file of several");
  AddAssignments(fit, arguments->assignments, "override an option, e.g. --set ingest.source.rate='30 Hz'");
  AddJobCount(fit, arguments->jobs);
  fit->add_flag("--contacts", arguments->contacts, "remove foot sliding: feet keep their place during contact");
  fit->add_flag("--force", arguments->force, "overwrite the output");
  fit->footer(
      "Clips of one person are measured and fitted as one body. Without a known person, each recording is a\n"
      "body of its own (change this with --set proportions.body_of=person or recording).\n\n"
      "Examples:\n  mocurate fit walk.bvh --skeleton smpl24 -o walk.h5\n"
      "  mocurate fit a01_s01_e01_realworld.txt --source kard -o clip.h5\n"
      "  mocurate fit clips.npz --clip '[walk]' --set ingest.source.rate='30 Hz' -o walk.h5\n"
      "  mocurate fit generated.h5 --contacts -o standing.h5");
  line.Calls(fit, FitVerb, arguments);
}

void AddRig(const CommandLine& line) {
  CLI::App* rig =
      line.app.add_subcommand("rig", "Audit a rig of keypoint cameras, and write it as a file for other takes");
  rig->require_subcommand(1);
  auto arguments = std::make_shared<RigAuditArguments>();
  CLI::App* audit = rig->add_subcommand("audit", "Audit the rig of all takes of a config together");
  audit->add_option("config", arguments->config, "YAML file, or the name of a job, as for run")->required();
  audit->add_option("-o,--output", arguments->output, "file of the audited rig (YAML)")->required();
  AddRepeated(
      audit, "--clip", arguments->clips,
      "take to audit: its clip id (source/person/recording), recording or file; may be repeated (default: all)");
  AddAssignments(audit, arguments->assignments, "override an option, e.g. --set ingest.path=DIR");
  AddJobCount(audit, arguments->jobs);
  audit->add_flag("--force", arguments->force, "overwrite the output");
  audit->footer(
      "Poses, clocks, files, mirrored images and exchanged sides are corrected as fitting.keypoints.audit says.\n"
      "Takes use the file with fitting.keypoints.rig: rig.yaml; then their own audit only reports. With one take,\n"
      "a confidence knows nothing of errors that last for that take; with several it is from the variation between "
      "them.\n\n"
      "Examples:\n  mocurate rig audit reannotate/pose2sim_both -o rig.yaml\n"
      "  mocurate rig audit my.yaml --clip take_01 --clip take_02 -o rig.yaml\n"
      "  mocurate run my.yaml --set fitting.keypoints.rig=rig.yaml");
  line.Calls(audit, RigAuditVerb, arguments);
}

}  // namespace

void AddRunVerbs(const CommandLine& line) {
  for (const auto add : {AddRun, AddPlan, AddJobs, AddFit, AddRig}) add(line);
}

}  // namespace mocurate
