#include "job/job_options.h"

#include <algorithm>

namespace mocurate {

void PipelineOptions::Declare(OptionVisitor& v) {
  v.OptionalNumber("item_timeout", item_timeout_s, Unit::kSecond, {0.001, {}},
                   "an item that runs longer is ended and counts as crashed; null: 1 h for stages of single clips, 1 d "
                   "for fitting, training and stages of the whole set (times --budget)");
  v.OptionalNumber("item_memory", item_memory_bytes, Unit::kByte, {1.0, {}},
                   "a worker with more memory is ended with its item; null: 8 GiB for stages of single clips, 16 "
                   "GiB for fitting, no limit for stages of the whole set");
}

void SlurmResources::Declare(OptionVisitor& v) {
  v.Text("partition", partition, "partition; empty: the cluster's default");
  v.OptionalNumber("time", time_s, Unit::kSecond, {120.0, {}},
                   "time limit, e.g. 30 min; null: of tasks three times the estimate and 10 min, else the partition's");
  v.OptionalNumber("memory", memory_bytes, Unit::kByte, {1.0, {}}, "memory, e.g. 4 GB; null: the partition's");
  v.Integer("cores", cores, {1, 1024}, "cores, and worker processes");
}

void SlurmOptions::Declare(OptionVisitor& v) {
  v.Text("account", account, "account that is charged; empty: yours");
  tasks.Declare(v);
  v.Group("step", step,
          "the jobs between stages, which verify, look for duplicates in the whole set and plan; empty partition: as "
          "of the tasks");
  v.Group("last", last, "the job that assembles, trains, scores and reports; empty partition: as of the tasks");
  v.Number("task_time", task_time_s, Unit::kSecond, {0.01, {}}, "a stage is cut into tasks of about this length");
  v.Integer("pilot", pilot, {0, 10000},
            "items executed between stages before a stage is cut for the first time, to know how long they take; 0: "
            "without any times, a stage is one task");
  v.Integer("at_once", at_once, {0, 100000}, "tasks that run at the same time, at most; 0: no limit");
  v.Integer("most_tasks", most_tasks, {0, 1000000},
            "tasks of a stage, at most; 0: what scontrol show config allows (MaxArraySize, MaxJobCount)");
  v.Text("scratch", scratch, "folder on a disk of the node for unfinished outputs, as shell text, e.g. $TMPDIR");
  v.Texts("prologue", prologue, "lines of shell before each job, e.g. module load hdf5");
  v.Texts("sbatch", sbatch, "further options of sbatch, e.g. --qos=low");
  v.Text("program", program,
         "how jobs call mocurate, as shell text, e.g. apptainer exec /shared/mocurate.sif mocurate; empty: this "
         "program by its path");
  v.Choice("submit_from", submit_from, {{"compute", SubmitFrom::kCompute}, {"login", SubmitFrom::kLogin}},
           "compute: a job between stages submits the next one; login: mocurate run waits and does it");
}

void DataSetOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the set's folder data/NAME and of its part of the table");
  v.Text("job", job, "config that makes its dataset: a name in configs/, or a path relative to the working folder");
  v.Path("path", path, "your copy of the set (--data NAME=PATH); empty: the substitute");
  v.Text("substitute", substitute, "layout of `mocurate synthesize` for a synthetic substitute where path is empty");
  v.Text("substitute_job", substitute_job, "config that makes the substitute's dataset; empty: `job`");
  v.Text("published", published, "name of the set in the published tables");
  v.Texts("networks", networks, "options of the networks for this set: NETWORK.OPTION=VALUE, or OPTION=VALUE for all");
  v.Texts("evaluate", evaluate, "options of `evaluate` for this set: OPTION=VALUE");
  v.Text("like", like,
         "an earlier set of the list: its job, path and substitute are the defaults of this set; its networks and "
         "evaluate options are applied first");
}

void DrawnSkeletonOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the rows on the skeleton");
  v.Text("person", person, "person of the set whose mean bone lengths it has");
  v.Text("scale", scale, "scaled bones: legs=1.25,arms=1.25 or all=1.25");
}

void DrawnMotionsOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the files below pictures/");
  v.Text("set", set, "set of `data` whose networks and dataset are drawn; empty: the first");
  v.Texts("rows", rows, "rows to draw: networks, rows of evaluate.rows, or Real (clips of the dataset)");
  v.Texts("labels", labels, "classes to draw; empty: all");
  v.Texts("scripts", scripts,
          "for networks that generate chains of actions: scripts instead of labels; a network of single actions makes "
          "each action by itself");
  v.Texts("themes", themes, "theme of each script");
  v.Integer("transition_frames", transition_frames, {0, 1000},
            "frames of each transition of scripts; 0: the network's usual number");
  v.Integer("samples", samples, {1, 100}, "number of motions of each row and label");
  v.Integer("stills", stills, {1, 60}, "number of equally spaced frames of a row");
  v.Bool("over_training", over_training, "draw each network after every step of its samples_at, in its own column");
  v.List("skeletons", skeletons, "skeletons on each of which each motion is drawn; empty: the network's own");
  v.Bool("continues", continues, "scripts continue motions of the set, which the rows begin with");
  v.Bool("unseen_pairs", unseen_pairs, "name pairs of actions of the scripts that no training sample has");
  v.Bool("path", path, "draw the root's path beside each row");
  v.Bool("world", world, "rows in one view, over the floor of their first frame");
  v.Bool("canonicalisation", canonicalisation,
         "without networks: a motion of the set that ends bent down, as in its source, facing the front, and with its "
         "root's rotation undone");
  v.TextMap("words", words, "class -> the paper's word for it");
  v.TextMap("colours", colours, "row -> red, green or blue");
  v.TextMap("absent", absent, "row that the paper has and this project does not -> why");
}

void PaperPlotOptions::Declare(OptionVisitor& v) {
  v.Text("title", title, "title of the plot");
  v.Text("metric", metric, "SET.METRIC, or METRIC of all sets");
  v.Text("right", right, "a second metric, on the axis on the right");
  v.TextMap("curves", curves, "row -> name of its curve; empty: all rows by their names");
  v.Numbers("solid", solid, Unit::kNone, {0.0, 1e9}, "least and largest number of the training; dashed beyond");
}

void PaperSurveyOptions::Declare(OptionVisitor& v) {
  v.Text("kind", kind, "kind of `mocurate survey make`: ranking, real_or_fake");
  v.Texts("rows", rows, "sources: networks, or Real (clips of the dataset)");
  v.Texts("labels", labels, "classes that are asked about; empty: all");
  v.Integer("samples", samples, {1, 1000}, "motions of each row and label");
  v.Integer("questions", questions, {0, 1000}, "number of questions; 0: the usual number");
  v.Text("skeleton", skeleton, "skeleton that the motions are fitted to, for skinned bodies; empty: none");
}

void ReleasedMotionsOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the row");
  v.Text("set", set, "set of `data` whose table contains the row");
  v.Text("protocol", protocol, "protocol: a name below configs/protocols");
  v.Path("motions", motions, "file of the motions, below MOCURATE_WEIGHTS");
  v.Path("labels", labels, "file of their classes, below MOCURATE_WEIGHTS");
  v.Path("bone_lengths", bone_lengths, "for Lie parameters: file of positions with the same bones");
  v.Text("method", method, "method of the published table that the row is compared with");
}

void ReproduceOptions::Declare(OptionVisitor& v) {
  v.Choice("kind", kind,
           {{"none", PaperItem::kNone},
            {"table", PaperItem::kTable},
            {"figure", PaperItem::kFigure},
            {"study", PaperItem::kStudy},
            {"diagram", PaperItem::kDiagram}},
           "item of a paper that the job reproduces: `mocurate reproduce list`");
  v.Text("shows", shows, "content of the paper's item");
  v.Text("conclusion", conclusion, "conclusion of the paper, where its numbers are not available");
  v.Text("recipe", recipe, "recipe whose clip counts by class are the rows of the table");
  v.Text("parts_of", parts_of, "network whose parameter counts by part are the rows of the table");
  v.Number("smoke_hours", smoke_hours, Unit::kNone, {0.0, {}}, "hours of profile smoke on two cores; 0: not measured");
  v.Number("small_hours", small_hours, Unit::kNone, {0.0, {}}, "hours of profile small on two cores; 0: not measured");
  v.Number("paper_hours", paper_hours, Unit::kNone, {0.0, {}}, "hours of profile paper on two cores; 0: not measured");
  v.TextMap("published_as", published_as, "row -> method of the published table that it is compared with; '': none");
  v.Text("curve", curve, "name of the variable N, where rows called 'NAME N' are points of a curve");
  v.List("plots", plots, "plots of the curves");
  v.List("released", released, "motions published by the authors, scored with their recogniser");
  v.List("pictures", pictures, "pictures of motions in rows of equally spaced frames");
  v.List("surveys", surveys, "studies: pages of questions about motions");
  v.Bool("screens", screens, "pictures of the pages of the studies, by Chromium");
}

void JobOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the job and of its run folder");
  v.Text("description", description, "description of the job, for the report");
  v.Text("takes", takes, "duration of the job, in words, and the machine");
  v.Text("skeleton", skeleton, "skeleton of the dataset: a name below configs/skeletons or a YAML file");
  v.Number("tolerated_failures", tolerated_failures, Unit::kNone, {0.0, 1.0},
           "share of failed clips above which the run ends with exit code 1");
  v.Number("tolerated_suspect", tolerated_suspect, Unit::kNone, {0.0, 1.0},
           "share of suspect clips (a finding of severity error) above which the run ends with exit code 1. Where "
           "more than half contradict their declaration, the declaration is wrong");
  v.Text("profile", profile, "profile of the config's `profiles` to merge into it, e.g. smoke, small, paper");
  v.List("data", data, "several sets; each runs through all stages with the networks of this job");
  v.Texts("substitutes", substitutes,
          "options of `mocurate synthesize` for the synthetic substitutes of all sets, e.g. subjects=3");
  v.Texts("network_options", network_options,
          "options of the networks for all sets in `data`, applied before those of each set: NETWORK.OPTION=VALUE or "
          "KIND.OPTION=VALUE");
  v.Group("ingest", ingest, "location and declaration of the captures");
  v.Group("proportions", proportions, "bone lengths of each person");
  v.Group("fitting", fitting, "rotations and bone lengths from evidence");
  v.Group("canon", canon, "trimming, place, heading and rate");
  v.Group("assemble", assemble, "the dataset file and its splits");
  v.Group("audit", audit, "figures about the dataset");
  v.Group("train", train, "networks");
  v.Group("evaluate", evaluate, "metrics and the table");
  v.Group("report", report, "the page of the run");
  v.Group("reproduce", reproduce, "item of a paper that the job reproduces");
  v.Group("pipeline", pipeline, "time and memory limits of a work item");
  v.Choice("executor", executor, {{"local", Executor::kLocal}, {"slurm", Executor::kSlurm}},
           "where stages with an item per clip run: on this machine, or as arrays of Slurm (mocurate run --executor)");
  v.Group("slurm", slurm, "what jobs of Slurm ask for; does not change results");
}

Status ResolveDataSets(std::vector<DataSetOptions>& sets) {
  for (std::size_t i = 0; i < sets.size(); ++i) {
    DataSetOptions& set = sets[i];
    if (set.like.empty()) continue;
    const auto end = sets.begin() + static_cast<std::ptrdiff_t>(i);
    const auto found = std::find_if(sets.begin(), end, [&](const DataSetOptions& one) { return one.name == set.like; });
    if (found == end) {
      return Fail(ErrorCode::kConfig, "no earlier set has the name '" + set.like + "'",
                  "data[" + std::to_string(i) + "].like", "name a set listed before it");
    }
    if (set.job.empty()) set.job = found->job;
    if (set.path.empty()) set.path = found->path;
    if (set.substitute.empty()) set.substitute = found->substitute;
    if (set.substitute_job.empty()) set.substitute_job = found->substitute_job;
    set.networks.insert(set.networks.begin(), found->networks.begin(), found->networks.end());
    set.evaluate.insert(set.evaluate.begin(), found->evaluate.begin(), found->evaluate.end());
  }
  return {};
}

void ResolveDefaults(JobOptions& options) {
  for (std::string* skeleton : {&options.proportions.skeleton, &options.fitting.skeleton, &options.canon.skeleton}) {
    if (skeleton->empty()) *skeleton = options.skeleton;
  }
  std::vector<std::string>& order = options.assemble.label_order;
  if (order.empty() && options.assemble.classes.empty()) {
    for (const auto& [text, label] : options.ingest.source.labels) {
      if (std::find(order.begin(), order.end(), label) == order.end()) order.push_back(label);
    }
  }
  const std::string recogniser = RecogniserOf(options);
  for (const NetworkOptions& network : options.train.networks) {
    if (network.name == recogniser && options.evaluate.split.empty()) options.evaluate.split = network.data.split;
  }
}

std::string RecogniserOf(const JobOptions& options) {
  if (!options.evaluate.recogniser.empty()) return options.evaluate.recogniser;
  for (const NetworkOptions& network : options.train.networks) {
    if (network.enabled && !GeneratesMotions(network.kind) && network.trained_on == TrainingSetChoice::kDataset)
      return network.name;
  }
  return {};
}

/// Its own group, with the method and clouds of `fitting`.
nlohmann::json ProportionsItemOptions(const JobOptions& options) {
  ProportionsOptions proportions;
  static_cast<ProportionsSettings&>(proportions) = options.proportions;
  proportions.method = options.fitting.method;
  proportions.other_joints = options.fitting.other_joints;
  proportions.point_clouds = options.fitting.point_clouds;
  proportions.keypoints = options.fitting.keypoints;
  proportions.keypoints.rig.clear();
  proportions.rules = options.fitting.rules;
  return OptionsToJson(proportions);
}

nlohmann::json FittingItemOptions(const JobOptions& options) {
  FittingOptions fitting = options.fitting;
  fitting.keypoints.rig.clear();
  return OptionsToJson(fitting);
}

nlohmann::json CanonItemOptions(const JobOptions& options) {
  CanonOptions canon = options.canon;
  canon.review.clear();
  canon.trim.spans.clear();
  canon.trim.by_example.examples.clear();
  return OptionsToJson(canon);
}

}  // namespace mocurate
