#include "app/job_options.h"

#include <algorithm>

namespace mocurate {

void PipelineOptions::Declare(OptionVisitor& v) {
  v.OptionalNumber(
      "item_timeout", item_timeout_s, Unit::kSecond, {0.001, {}},
      "an item that runs longer is ended and counts as crashed; null: 1 h where one clip is looked at, 1 d "
      "in fitting, training and what works on the whole set (times --budget)");
  v.OptionalNumber(
      "item_memory", item_memory_bytes, Unit::kByte, {1.0, {}},
      "a worker that holds more memory is ended with its item; null: 8 GiB where one clip is looked at, 16 "
      "GiB in fitting, no limit where the whole set is held");
}

void DataSetOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "of its folder data/NAME and its part of the table");
  v.Text("job", job, "config that makes its dataset: a name of configs/, or a file from the working folder");
  v.Path("path", path, "your copy of the set (--data NAME=PATH); empty: the substitute");
  v.Text("substitute", substitute,
         "layout of `mocurate synthesize` in which a stand-in is written where path is empty");
  v.Text("substitute_job", substitute_job, "config that makes the stand-in's dataset, where `job` does not");
  v.Text("published", published, "name of the set in the published tables");
  v.Texts("networks", networks,
          "options of the networks for this set: NETWORK.OPTION=VALUE, or OPTION=VALUE of all of them");
  v.Texts("evaluate", evaluate, "options of `evaluate` for this set: OPTION=VALUE");
  v.Text(
      "like", like,
      "set before it whose job, path and substitute it takes where it has none; its networks and evaluate go on top");
}

void DrawnMotionsOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "of its files below pictures/");
  v.Text("set", set, "set of `data` whose networks and dataset are shown; empty: the first");
  v.Texts("rows", rows, "networks, rows of evaluate.rows, or Real: clips of the dataset");
  v.Texts("labels", labels, "classes that are shown; empty: all");
  v.Texts("scripts", scripts, "scripts in the place of labels, for networks that answer them");
  v.Integer("transition_frames", transition_frames, {0, 1000}, "of all transitions of scripts; 0: usual ones");
  v.Integer("samples", samples, {1, 100}, "motions of each row and label");
  v.Text("frames", frames, "of each motion: 60, or FIRST:LAST:STEP; empty: as many as the network was trained on");
  v.Integer("interpolate", interpolate, {0, 100}, "motions between two latents in the place of samples; 0: none");
  v.Bool("denoise", denoise, "networks show the clips of the dataset, encoded and decoded");
  v.Integer("stills", stills, {1, 60}, "equally spaced frames of a row");
}

void ReleasedMotionsOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "of the row");
  v.Text("set", set, "set of `data` in whose table it stands");
  v.Text("protocol", protocol, "how it is scored: a name below configs/protocols");
  v.Path("motions", motions, "the motions, a file below MOCURATE_WEIGHTS");
  v.Path("labels", labels, "their classes, a file below MOCURATE_WEIGHTS");
  v.Path("bone_lengths", bone_lengths, "of Lie parameters: a file of positions whose bones they have");
  v.Text("method", method, "method of the published table that it stands beside");
}

void ReproduceOptions::Declare(OptionVisitor& v) {
  v.Choice("kind", kind,
           {{"none", PaperItem::kNone},
            {"table", PaperItem::kTable},
            {"figure", PaperItem::kFigure},
            {"study", PaperItem::kStudy},
            {"diagram", PaperItem::kDiagram}},
           "what of a paper the job reproduces: `mocurate reproduce list`");
  v.Text("shows", shows, "what the paper's item shows");
  v.Text("conclusion", conclusion, "what the paper concludes, where its numbers are not at hand");
  v.Text("recipe", recipe, "recipe whose numbers of clips by class are the rows of the table");
  v.Text("parts_of", parts_of, "network whose numbers of parameters by part are the rows of the table");
  v.Number("smoke_hours", smoke_hours, Unit::kNone, {0.0, {}}, "hours of profile smoke on two cores; 0: not measured");
  v.Number("small_hours", small_hours, Unit::kNone, {0.0, {}}, "hours of profile small on two cores; 0: not measured");
  v.Number("paper_hours", paper_hours, Unit::kNone, {0.0, {}}, "hours of profile paper on two cores; 0: not measured");
  v.TextMap("published_as", published_as, "row: method of the published table that it stands beside; '': none");
  v.Text("curve", curve, "name of N where rows 'NAME N' are points of a curve");
  v.Texts("plotted", plotted, "SET.METRIC that the curves show; empty: all");
  v.List("released", released, "motions that the authors published, scored by their recogniser");
  v.List("pictures", pictures, "pictures of motions in rows of equally spaced frames");
  v.Texts("surveys", surveys, "pages of questions about the motions of the first picture: preference, real_or_fake");
}

void JobOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the job and of its run folder");
  v.Text("description", description, "what the job is, for the report");
  v.Text("takes", takes, "how long the job takes, in words, and on what machine");
  v.Text("skeleton", skeleton, "skeleton of the dataset: a name below configs/skeletons or a YAML file");
  v.Number("tolerated_failures", tolerated_failures, Unit::kNone, {0.0, 1.0},
           "share of the clips that may fail before the run ends with exit code 1");
  v.Number("tolerated_doubtful", tolerated_doubtful, Unit::kNone, {0.0, 1.0},
           "share of the clips that go on with a finding of severity error before the run ends with exit code 1: where "
           "more than half contradict their declaration, it is the declaration that is wrong");
  v.Text("profile", profile, "which of the config's `profiles` is merged into it, e.g. smoke, small, paper");
  v.List("data", data, "several sets, each of which goes through all stages with the networks of this job");
  v.Texts("substitutes", substitutes, "options of the studio for all substitutes, e.g. subjects=3");
  v.Texts("network_options", network_options,
          "options of the networks of all sets in `data`, before each set's own: NETWORK.OPTION=VALUE or "
          "KIND.OPTION=VALUE");
  v.Group("ingest", ingest, "where the captures are and what they are");
  v.Group("proportions", proportions, "bone lengths of each person");
  v.Group("fitting", fitting, "rotations and bone lengths from evidence");
  v.Group("canon", canon, "trimming, place, heading and rate");
  v.Group("assemble", assemble, "the dataset file and its splits");
  v.Group("audit", audit, "figures about the dataset");
  v.Group("train", train, "networks");
  v.Group("evaluate", evaluate, "metrics and the table");
  v.Group("report", report, "the page of the run");
  v.Group("reproduce", reproduce, "what of a paper the job reproduces");
  v.Group("pipeline", pipeline, "what an item of work may take");
}

Status ResolveDataSets(std::vector<DataSetOptions>& sets) {
  for (std::size_t i = 0; i < sets.size(); ++i) {
    DataSetOptions& set = sets[i];
    if (set.like.empty()) continue;
    const auto end = sets.begin() + static_cast<std::ptrdiff_t>(i);
    const auto found = std::find_if(sets.begin(), end, [&](const DataSetOptions& one) { return one.name == set.like; });
    if (found == end) {
      return Fail(ErrorCode::kConfig, "no set before it has the name '" + set.like + "'",
                  "data[" + std::to_string(i) + "].like", "name a set that stands above it");
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

ProportionsOptions ProportionsOf(const JobOptions& options) {
  ProportionsOptions proportions;
  static_cast<ProportionsSettings&>(proportions) = options.proportions;
  proportions.method = options.fitting.method;
  proportions.other_joints = options.fitting.other_joints;
  proportions.point_clouds = options.fitting.point_clouds;
  proportions.keypoints = options.fitting.keypoints;
  return proportions;
}

}  // namespace mocurate
