#include "eval/options.h"

#include "core/base/text.h"
#include "eval/stages.h"

namespace mocurate {
namespace {

void DeclareLabels(LabelDraw& labels, OptionVisitor& v) {
  v.Choice("labels", labels, {{"uniform", LabelDraw::kUniform}, {"natural", LabelDraw::kNatural}},
           "frequencies of generated labels: uniform (Action2Motion) or those of the real set (ACTOR)");
}

void DeclarePerLabel(std::int64_t& per_label, OptionVisitor& v) {
  v.Integer("per_label", per_label, {0.0, 1e6}, "maximum motions of each label in a repetition; 0: no limit");
}

void DeclareHidden(HiddenDraw& hidden, OptionVisitor& v) {
  v.Choice("hidden", hidden, {{"zero", HiddenDraw::kZero}, {"normal", HiddenDraw::kNormal}},
           "initial hidden states of the extractor: zero, or drawn for each motion as in the released codes");
}

void DeclareCrop(CropDraw& crop, OptionVisitor& v) {
  v.Choice("crop", crop, {{"first", CropDraw::kFirst}, {"released", CropDraw::kReleased}, {"any", CropDraw::kAny}},
           "window of a motion that is too long: its first frames, or a random window, without the last start (as "
           "released) or with it");
}

void DeclareMeasures(MeasureSet& measures, OptionVisitor& v) {
  v.Choice("measures", measures, {{"own", MeasureSet::kOwn}, {"mbench", MeasureSet::kMBench}},
           "measures of single motions: own; mbench: MBench's five joint measures as well, per frame of the files");
}

void DeclareReal(RealPart& real, OptionVisitor& v) {
  v.Choice("real", real, {{"all", RealPart::kAll}, {"train", RealPart::kTrain}, {"test", RealPart::kTest}},
           "clips used as real motions: all (as published), or one part of the split");
}

void DeclareInterval(IntervalKind& interval, OptionVisitor& v) {
  v.Choice("interval", interval,
           {{"student", IntervalKind::kStudent},
            {"action2motion", IntervalKind::kAction2Motion},
            {"actor", IntervalKind::kActor}},
           "meaning of +-: Student's t (MultiAct), 1.96 sd / sqrt(n) (Action2Motion), or 1.96 times the "
           "variance (ACTOR: not an interval)");
}

void DeclarePart(const char* name, ClipPart& part, OptionVisitor& v) {
  v.Choice(name, part,
           {{"whole", ClipPart::kWhole}, {"transition", ClipPart::kTransition}, {"action", ClipPart::kAction}},
           "scored part of samples of two actions: all, only the transition, or only the second action (MultiAct)");
}

void DeclareScript(ScriptDraw& script, OptionVisitor& v) {
  v.Choice("script", script,
           {{"none", ScriptDraw::kNone},
            {"after_sample", ScriptDraw::kAfterSample},
            {"after_generated", ScriptDraw::kAfterGenerated},
            {"chain", ScriptDraw::kChain}},
           "request to the generator: a label and a length; the transition and action of a sample, after its previous "
           "motion or after a generated one; or a chain of drawn actions");
}

void DeclareFilter(OneEuro& filter, OptionVisitor& v) {
  v.Number("least_cutoff", filter.least_cutoff_hz, Unit::kHertz, {0.0, 1000.0},
           "1-euro filter: cutoff at rest; 0: no filter");
  v.Number("speed", filter.speed, Unit::kNone, {0.0, 1000.0}, "1-euro filter: increase of the cutoff in Hz per m/s");
  v.Number("speed_cutoff", filter.speed_cutoff_hz, Unit::kHertz, {0.001, 1000.0},
           "1-euro filter: cutoff of the derivative");
}

void DeclareRoot(const char* name, RootRule& rule, const char* help, OptionVisitor& v) {
  v.Choice(name, rule,
           {{"as_given", RootRule::kAsGiven},
            {"first_frame", RootRule::kFirstFrame},
            {"every_frame", RootRule::kEveryFrame}},
           help);
}

}  // namespace

void ExtractorOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the extractor");
  v.Text("weights", weights,
         "weights file: a path, or a name below the folder MOCURATE_WEIGHTS; a checkpoint of "
         "mocurate needs no other option");
  v.Text("obtain", obtain, "where the weights come from");
  v.Choice("network", network, {{"gru", ExtractorNetwork::kGru}, {"st_gcn", ExtractorNetwork::kStGcn}},
           "network of the weights");
  v.Choice("values", values,
           {{"joints", ExtractorValues::kJoints}, {"rotation_6d_rows", ExtractorValues::kRotation6DRows}},
           "network input of a frame");
  v.Text("skeleton", skeleton, "joints in the network's order: a name below configs/skeletons, or a YAML file");
  v.Text("axes", axes, "directions of the network's +x, +y and +z in canonical axes: '+x -y -z' is y down, facing -z");
  v.Number("metres_per_unit", metres_per_unit, Unit::kNone, {1e-6, 1e6}, "length of the network's unit");
  v.Number("rate", rate_hz, Unit::kHertz, {0.0, 1000.0},
           "rate of the training motions; other rates are a warning; 0: unknown");
  v.Integer("frames", frames, {2.0, 10000.0}, "frames that the network reads");
  v.Choice("length", length, {{"crop", LengthRule::kCrop}, {"resample", LengthRule::kResample}},
           "conversion of a motion of another length to `frames`: a window with padding, or resampling");
  v.Choice("padding", padding,
           {{"repeat_last", PaddingRule::kRepeatLast},
            {"zeros", PaddingRule::kZeros},
            {"zeros_minus_root", PaddingRule::kZerosMinusRoot}},
           "padding of a motion that is too short");
  v.Choice("read_out", read_out, {{"last_frame", ReadOut::kLastFrame}, {"last_valid", ReadOut::kLastValid}},
           "frame whose output is used: the last one including padding, or the last of the motion");
  DeclareRoot("real_root", real_root, "origin of the joints of real motions", v);
  DeclareRoot("generated_root", generated_root, "origin of the joints of generated motions", v);
  v.Choice("body", body, {{"own", BodyRule::kOwn}, {"mean_shape", BodyRule::kMeanShape}},
           "bone lengths of the joints: the motion's own, or those of SMPL's mean body");
  v.Number("yaw", yaw_rad, Unit::kRadian, {-7.0, 7.0},
           "rotation of the scored motions, not of the reference, about the vertical: shows how much a network depends "
           "on the "
           "view");
  v.Texts("classes", classes, "class names in the order of the network's outputs");
}

void FilterRowOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the row");
  v.Text("network", network, "network whose motions are filtered");
  DeclareFilter(filter, v);
}

void ScriptRowOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the row");
  v.Text("network", network, "name in train.networks: a macvae, or an actor whose motions are joined");
  DeclareScript(script, v);
  v.Text("first", first, "actor network that generates the first action where `network` is a macvae");
  v.Text("fill", fill, "ssmct network that fills transitions between joined actions; empty: interpolation");
  v.Bool("align", align, "rotate and move each joined action to the end of the one before");
  v.Integer("steps", steps, {1.0, 1000.0}, "steps of a chain, each a row of its own");
}

void DrawOptions::Declare(OptionVisitor& v) {
  v.Integer("repetitions", repetitions, {1.0, 1000.0}, "number of repetitions of the whole evaluation");
  v.Integer("motions", motions, {0.0, 1e6}, "motions per set and repetition; 0: each motion once");
  v.Bool("replacement", replacement, "draw real motions with replacement");
  DeclarePerLabel(per_label, v);
  DeclareLabels(labels, v);
  DeclareHidden(hidden, v);
  DeclareCrop(crop, v);
  DeclareInterval(interval, v);
}

void MetricOptions::Declare(OptionVisitor& v) {
  v.Integer("diversity_pairs", diversity_pairs, {1.0, 1e6}, "pairs for diversity");
  v.Integer("multimodality_quota", multimodality_quota, {1.0, 1e5}, "pairs per class for multimodality");
  v.Choice("divisor", divisor, {{"present", MultimodalityDivisor::kPresent}, {"all", MultimodalityDivisor::kAll}},
           "multimodality where a class has no motions: no value, or divided by all classes (MultiAct)");
  v.Number(
      "least_movement", least_movement, Unit::kNone, {0.0, 10.0},
      "a row whose motions move less than this share of the real ones of their label has the warning hardly_moves");
}

const DrawOptions& ProtocolOptions::draw() const {
  return variant == ProtocolVariant::kReleased ? released : variant == ProtocolVariant::kPaper ? from_paper : given;
}

void ProtocolOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the protocol");
  v.Text("paper", paper, "paper of the protocol");
  v.Text("dataset", dataset, "data set, by its name in the published tables");
  v.Text("recipe", recipe, "recipe of the real motions, a name below configs/recipes");
  v.Text("extractor", extractor, "a name below configs/extractors, or a YAML file");
  v.Choice("variant", variant,
           {{"given", ProtocolVariant::kGiven},
            {"released", ProtocolVariant::kReleased},
            {"paper", ProtocolVariant::kPaper}},
           "drawing of motions. given: every motion once; released: as in the paper's code; paper: as in its text");
  v.Integer("seed", seed, {}, "random seed of all draws");
  v.Bool("test_reference", test_reference, "score against the test part of the real motions as well (FID_test)");
  v.Text("split", split, "split of the real motions; empty: the first one");
  DeclarePart("part", part, v);
  v.Group("given", given, "draws of the variant given");
  v.Group("released", released, "draws of the variant released");
  v.Group("from_paper", from_paper, "draws of the variant paper");
  v.Group("metrics", metrics, "sizes of the metrics");
  DeclareMeasures(measures, v);
  v.TextMap("equivalent", equivalent, "class -> classes accepted for it, separated by ', '; itself included");
  v.Numbers("original_clips", original_clips, Unit::kNone, {0.0, 1e9}, "clips of the paper's own real set");
  v.Bool("original_data", original_data,
         "the real motions are the paper's own data: values outside the published intervals are marked");
  v.Texts("notes", notes, "notes for readers of the table");
}

DrawOptions EvaluateOptions::draw() const {
  DrawOptions options;
  options.repetitions = repetitions;
  options.motions = motions;
  options.replacement = replacement;
  options.labels = labels;
  options.hidden = random_hidden ? HiddenDraw::kNormal : HiddenDraw::kZero;
  options.crop = CropDraw::kReleased;
  options.interval = interval;
  return options;
}

MetricOptions EvaluateOptions::metrics() const {
  MetricOptions options;
  options.diversity_pairs = diversity_pairs;
  options.multimodality_quota = multimodality_quota;
  return options;
}

void EvaluateOptions::Declare(OptionVisitor& v) {
  v.Text("published", published,
         "set whose published numbers are listed below the table, by its name in the papers' tables");
  v.Text("paper", paper, "paper of the published numbers: Action2Motion, ACTOR, MultiAct");
  v.Text("table", table, "number of the paper's table; empty: all of them");
  v.Text("recogniser", recogniser,
         "network for the features of the metrics; empty: the first recogniser trained on the dataset");
  v.Bool("generators", generators, "score generators and real motions; false: only the recognisers");
  v.Integer("seed", seed, {}, "random seed of the evaluation");
  v.Integer("repetitions", repetitions, {1.0, 1000.0}, "number of repetitions of the whole evaluation");
  v.Integer("motions", motions, {0.0, 1e6}, "motions per set and repetition; 0: each once");
  v.Bool("replacement", replacement, "draw real motions with replacement (Action2Motion), or without (ACTOR)");
  DeclareRoot("real_root", real_root, "origin of the joints of real motions as the recogniser reads them", v);
  DeclareRoot("generated_root", generated_root, "the same of generated motions", v);
  v.Text("protocol", protocol,
         "protocol in configs/protocols that sets the equivalent labels and the divisor of multimodality");
  v.Text(
      "published_protocol", published_protocol,
      "protocol in configs/protocols whose published recogniser scores the rows as well, where its weights are below "
      "MOCURATE_WEIGHTS; empty: none");
  v.List("filters", filters, "additional rows: motions of a network after a 1-euro filter");
  v.List("rows", rows,
         "rows of networks that generate chains of actions (scripts, MultiAct); empty: one row per generator");
  DeclarePart("part", part, v);
  v.Bool("yardsticks", yardsticks,
         "rows beside which others can be read: training clips of the label, of any label, the mean pose of the label");
  v.Bool("requests_of_test", requests_of_test,
         "draw the labels and lengths that generators get from the test part; false: from the real motions");
  v.Numbers("durations", durations, Unit::kNone, {1.0, 5000.0},
            "requested lengths in frames, one row per length; empty: the length that the recogniser reads");
  v.Integer("diversity_pairs", diversity_pairs, {1.0, 1e6}, "pairs for diversity");
  v.Integer("multimodality_quota", multimodality_quota, {1.0, 1e5}, "pairs per class for multimodality");
  DeclareMeasures(measures, v);
  DeclareLabels(labels, v);
  DeclareReal(real, v);
  v.Bool("test_reference", test_reference,
         "two FIDs: against the training and validation parts, and against the test part; `real` is ignored");
  v.Number("settled", settled, Unit::kNone, {0.0, 1.0},
           "a network whose FID changed by more than this share since its last sample counts as not converged");
  v.Number("least_real_accuracy", least_real_accuracy, Unit::kNone, {0.0, 1.0},
           "a table is void where the recogniser recognises less of the real motions");
  v.Text("split", split, "split whose test part scores the recogniser; empty: the recogniser's, else the first");
  DeclareInterval(interval, v);
  v.Bool("random_hidden", random_hidden, "start the recogniser from normal hidden states, as the released code does");
}

std::vector<std::string> NotesOf(const EvaluateOptions& options) {
  const char* real[] = {"all clips", "training clips", "test clips"};
  const std::string of = options.test_reference ? "training and validation clips (FID train) and test clips (FID test)"
                                                : real[static_cast<int>(options.real)];
  return {"Real motions: " + of + ". Generated labels: " +
          (options.labels == LabelDraw::kUniform ? "uniform" : "as frequent as in the real set") + ". " +
          Counted(options.repetitions, "repetition") + " of " +
          (options.motions == 0 ? std::string("each motion once") : Counted(options.motions, "motion")) +
          ", initial hidden state of the recogniser " + (options.random_hidden ? "random." : "zero.")};
}

void FeaturesOptions::Declare(OptionVisitor& v) {
  v.Group("extractor", extractor, "network that computes the features, and how motions become its input");
  v.Bool("generated", generated, "the motions are generated ones");
  v.Bool("known_frame", known_frame, "a network of this run generated the set, so axes and unit are known");
  DeclareReal(part, v);
  v.Text("split", split, "split of the part; empty: the first one");
  v.Integer("seed", seed, {}, "random seed of the draws");
  v.Text("purpose", purpose, "name of the draws");
  v.Integer("passes", passes, {0.0, 1000.0},
            "number of passes, each with new random draws; 0: one pass in the order of the motions");
  v.Integer("motions", motions, {0.0, 1e6}, "motions drawn per pass; 0: all");
  v.Integer("frames", frames, {0.0, 5000.0},
            "frames requested from a generator and read from its motions; 0: as many as the extractor reads");
  v.Bool("replacement", replacement, "draw with replacement");
  DeclarePerLabel(per_label, v);
  DeclareLabels(labels, v);
  DeclareHidden(hidden, v);
  DeclareCrop(crop, v);
  DeclarePart("clip_part", clip_part, v);
  v.Choice("yardstick", yardstick,
           {{"none", Yardstick::kNone},
            {"retrieval", Yardstick::kRetrieval},
            {"shuffled_labels", Yardstick::kShuffledLabels},
            {"mean_pose", Yardstick::kMeanPose}},
           "answer of each request in the place of a generator's");
  DeclareScript(script, v);
  v.Integer("steps", steps, {1.0, 1000.0}, "steps of a chain");
  v.Integer("step", step, {1.0, 1000.0}, "scored step of a script");
  v.Bool("align", align, "rotate and move joined motions");
  DeclareFilter(filter, v);
  DeclareMeasures(measures, v);
  DeclarePadding(padding, v);
}

void ScoreOptions::Declare(OptionVisitor& v) {
  v.Text("name", name, "name of the row");
  v.Choice("real", real, {{"none", RealRow::kNone}, {"train", RealRow::kTrain}, {"test", RealRow::kTest}},
           "for a row of real motions: the reference part that contains them; none: generated motions");
  v.Integer("seed", seed, {}, "random seed of the draws");
  v.Group("draw", draw, "draws of the row");
  v.Group("metrics", metrics, "sizes of the metrics");
  v.TextMap("equivalent", equivalent, "class -> classes accepted for it");
}

StageDeclaration FeaturesDeclaration() { return {"features", 11, "mocurate-learn", WholeSetLimits()}; }
StageDeclaration ScoreDeclaration() { return {"score", 6, "mocurate-learn", WholeSetLimits()}; }
StageDeclaration CompareDeclaration() { return {"compare", 5, "mocurate-learn", WholeSetLimits()}; }
StageDeclaration FitErrorDeclaration() { return {"fit_error", 6, "mocurate-annotate", WholeSetLimits()}; }

}  // namespace mocurate
