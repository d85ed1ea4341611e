#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/pi.h"
#include "core/base/random.h"
#include "core/base/text.h"
#include "core/formats/amass.h"
#include "core/formats/babel.h"
#include "ingest/synthetic/humanact12_set.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/take_plan.h"

namespace mocurate {
namespace {

/// BABEL's annotation of an action: processed label and categories.
struct BabelWords {
  std::string proc_label;
  std::vector<std::string> categories;
};

/// A long sequence with the labels of each of its actions.
struct AnnotatedSequence {
  PlannedSequence sequence;
  std::vector<BabelWords> words;  ///< of sequence.script.actions
};

/// An action of the studio with BABEL's labels, and how often it is repeated.
struct BabelAction {
  const char* action;
  const char* proc_label;
  std::vector<std::string> categories;
  double least_cycles, most_cycles;
};

const std::vector<BabelAction>& BabelActions() {
  static const std::vector<BabelAction> actions = {
      {"walk", "walk", {"walk"}, 1.0, 2.5},
      {"run", "run", {"run"}, 1.5, 3.5},
      {"run_on_the_spot", "jog", {"jog"}, 1.5, 3.5},
      {"turn", "turn around", {"turn"}, 1.0, 2.0},
      {"jump", "jump", {"jump"}, 1.0, 1.0},
      {"kick", "kick", {"kick", "foot movements"}, 1.0, 1.0},
      {"sit", "sit down", {"sit"}, 1.0, 1.0},
      {"stand_up", "stand up", {"stand up"}, 1.0, 1.0},
      {"squat", "squat", {"squat"}, 1.0, 1.0},
      {"throw", "throw", {"throw", "arm movements"}, 1.0, 1.0},
      {"pick_up", "pick up", {"take/pick something up"}, 1.0, 1.0},
      {"pick_up_object", "pick up object", {"take/pick something up"}, 1.0, 1.0},
      {"put_down_object", "put down object", {"place something"}, 1.0, 1.0},
      {"place", "place", {"place something"}, 1.0, 1.0},
      {"catch", "catch", {"catch"}, 1.0, 1.0},
      {"stay_seated", "sit", {"sit"}, 1.0, 1.0},
      {"bend_down", "bend down", {"bend"}, 1.0, 1.0},
      {"warm_up_bow_right", "bend over", {"bend"}, 1.0, 1.0},
      {"wave", "wave", {"wave", "gesture"}, 1.5, 3.5},
      {"punch", "punch", {"punch", "martial art"}, 1.0, 2.5},
      {"clap", "clap", {"clap"}, 1.5, 3.5},
      {"salute", "salute", {"gesture", "greet"}, 1.0, 1.0}};
  return actions;
}

constexpr int kLeastActions = 5, kMostActions = 9;
constexpr double kTransition_s = 0.7;

/// Several short everyday actions one after the other, half of them without a pause between, with BABEL's labels
/// (18 of MultiAct's 53 labels, and others). An action takes one to three seconds, as most of BABEL's do.
/// options.actions are those labels or the studio's names.
AnnotatedSequence PlanBabelSequence(const StudioOptions& options, int subject, int number, double rate_hz) {
  AnnotatedSequence annotated{{subject, number, {}, {}}, {}};
  PlannedSequence& sequence = annotated.sequence;
  Random random(static_cast<std::uint64_t>(options.seed), "studio.babel_sequence", sequence.Key());
  std::vector<const BabelAction*> choice;
  for (const BabelAction& action : BabelActions()) {
    if (IsWanted(options.actions, {action.proc_label, action.action})) choice.push_back(&action);
  }
  Script& script = sequence.script;
  script.transition_s = kTransition_s;
  const auto frames = [&](double seconds) { return static_cast<int>(std::lround(seconds * rate_hz)); };
  int frame = frames(random.Uniform(0.6, 2.0));
  const int count = kLeastActions + static_cast<int>(random.Below(kMostActions - kLeastActions + 1));
  for (int k = 0; k < count; ++k) {
    const BabelAction& action = *choice[random.Below(choice.size())];
    Manner manner = NaturalManner(action.action, 0.0, random);
    const bool repeats = NaturalPeriod(action.action) > 0.0;
    manner.cycles = random.Uniform(action.least_cycles, action.most_cycles);
    manner.active_s = NaturalDuration(action.action, repeats ? manner.cycles : 0.0) / random.Uniform(0.9, 1.25);
    const int end = frame + std::max(2, frames(manner.active_s));
    script.actions.push_back({action.action, frame, end, manner});
    annotated.words.push_back({action.proc_label, action.categories});
    // Half of the actions follow each other directly: the transition fills the time between them.
    const bool rests = random.Uniform() < 0.5;
    frame = end + frames(rests ? random.Uniform(1.8, 3.5) : kTransition_s);
  }
  script.frames = frame;
  script.sway_phase = random.Uniform(0.0, 2.0 * kPi);
  script.heading = random.Uniform(-kPi, kPi);
  return annotated;
}

/// Error kConfig for an unknown name in options.actions, with the nearest.
Status CheckBabelWords(const std::vector<std::string>& wanted) {
  std::vector<std::string> known;
  for (const BabelAction& action : BabelActions()) known.insert(known.end(), {action.proc_label, action.action});
  return CheckWanted(wanted, known);
}

constexpr const char* kDataset = "STUDIO";
constexpr std::int64_t kAmassRateHz = 120;
constexpr std::int64_t kSubjects = 4;
constexpr std::int64_t kSequences = 5;
constexpr std::size_t kPoseColumns = 156;  // SMPL-H: root, 21 of the body, two hands of 15
constexpr std::size_t kBodyColumns = 66;

/// HumanAct12's variants with BABEL's labels.
BabelWords WordsOfVariant(const HumanAct12Variant& variant) {
  const std::string label = variant.label;
  if (label == "warm_up") return {"warm up", {"exercise/training"}};
  if (label == "lift_dumbbell") return {"lift weight", {"lift something", "exercise/training"}};
  if (label == "turn_steering_wheel") return {"turn steering wheel", {"hand movements", "sit"}};
  if (label == "phone") return {"talk on phone", {"telephone call"}};
  if (label == "boxing") return {"box", {"punch", "martial art"}};
  if (label == "sit") return {"sit down", {"sit"}};
  return {variant.label, {label}};
}

Amass AmassOf(const Motion& motion) {
  // y up to z up: (x, y, z) -> (x, -z, y).
  const RigidTransform z_up{Quaterniond(Eigen::AngleAxisd(0.5 * kPi, Vector3d::UnitX())), Vector3d::Zero()};
  const Motion seen = SelectFrames(motion, z_up);
  Amass amass;
  amass.rate_hz = static_cast<double>(kAmassRateHz);
  amass.gender = "neutral";
  amass.frames = static_cast<std::size_t>(motion.frame_count());
  amass.pose_columns = kPoseColumns;
  amass.poses.assign(amass.frames * kPoseColumns, 0.0);
  amass.betas.assign(16, 0.0);
  for (int f = 0; f < seen.frame_count(); ++f) {
    const std::vector<double> pose = RotationVectors(seen, f);
    std::copy_n(pose.begin(), kBodyColumns, amass.poses.begin() + static_cast<std::ptrdiff_t>(kPoseColumns) * f);
    const Vector3d root = seen.root_translation[f];
    amass.translation_m.insert(amass.translation_m.end(), root.data(), root.data() + 3);
  }
  return amass;
}

std::string TakeOf(const PlannedSequence& sequence) {
  return ZeroPadded(sequence.subject, 2) + "_" + ZeroPadded(sequence.number, 2);
}

/// How a person waits for an action: most stand, some sit.
BabelWords WordsOfWaiting(const ScriptedAction& next) {
  Pose pose;
  Perform(next.action, 0.0, next.manner, pose);
  const char* word = pose.leg[kLeftSide].knee > 0.8 ? "sit" : "stand";
  return {word, {word}};
}

double RoundedToMillisecond(double seconds) { return std::round(1000.0 * seconds) / 1000.0; }

std::string SegmentId(Random& random) {
  std::string id;
  for (int k = 0; k < 32; ++k) {
    if (k == 8 || k == 12 || k == 16 || k == 20) id += '-';
    id += "0123456789abcdef"[random.Below(16)];
  }
  return id;
}

BabelLabel LabelOfSpan(const BabelWords& words, const ScriptSpan& span, Random& random) {
  BabelLabel label;
  label.raw_label = words.proc_label;
  label.proc_label = words.proc_label;
  label.act_cat = words.categories;
  label.seg_id = SegmentId(random);
  label.start_t = RoundedToMillisecond(static_cast<double>(span.begin) / kAmassRateHz);
  label.end_t = RoundedToMillisecond(static_cast<double>(span.end) / kAmassRateHz);
  return label;
}

/// Labels of all actions, of the transitions between them and of waiting; unsorted, and sometimes overlapping, as in
/// the real set.
BabelSequence AnnotationOf(const StudioOptions& options, const AnnotatedSequence& annotated, std::int64_t sid) {
  const PlannedSequence& sequence = annotated.sequence;
  Random random(static_cast<std::uint64_t>(options.seed), "studio.babel", sequence.Key());
  const Script& script = sequence.script;
  const std::vector<ScriptSpan> ways = Transitions(script, FrameRate{kAmassRateHz, 1});
  BabelAnnotation annotation;
  annotation.babel_lid = SegmentId(random);
  annotation.anntr_id = SegmentId(random);
  annotation.mul_act = true;
  if (script.actions.front().begin > 0) {
    annotation.labels.push_back(
        LabelOfSpan(WordsOfWaiting(script.actions.front()), {0, script.actions.front().begin}, random));
  }
  for (std::size_t k = 0; k < script.actions.size(); ++k) {
    annotation.labels.push_back(
        LabelOfSpan(annotated.words[k], {script.actions[k].begin, script.actions[k].end}, random));
    if (k >= ways.size()) continue;
    annotation.labels.push_back(LabelOfSpan({"transition", {"transition"}}, ways[k], random));
    const ScriptedAction& next = script.actions[k + 1];
    if (next.begin > ways[k].end)
      annotation.labels.push_back(LabelOfSpan(WordsOfWaiting(next), {ways[k].end, next.begin}, random));
  }
  for (std::size_t i = annotation.labels.size(); i > 1; --i) {
    std::swap(annotation.labels[i - 1], annotation.labels[random.Below(i)]);
  }
  BabelSequence babel;
  babel.babel_sid = sid;
  babel.key = std::to_string(sid);
  babel.url = ZeroPadded(static_cast<int>(sid), 6) + ".mp4";
  babel.feat_p =
      std::string(kDataset) + "/" + kDataset + "/" + sequence.Person() + "/" + TakeOf(sequence) + "_poses.npz";
  babel.dur = std::round(100.0 * script.frames / static_cast<double>(kAmassRateHz)) / 100.0;
  BabelAnnotation whole;
  whole.babel_lid = SegmentId(random);
  whole.anntr_id = annotation.anntr_id;
  whole.mul_act = true;
  for (const BabelWords& words : annotated.words) {
    BabelLabel label = LabelOfSpan(words, {0, 0}, random);
    label.start_t.reset();
    label.end_t.reset();
    whole.labels.push_back(std::move(label));
  }
  babel.seq_anns.push_back(std::move(whole));
  babel.frame_anns.push_back(std::move(annotation));
  return babel;
}

AnnotatedSequence InBabelWords(PlannedSequence sequence) {
  AnnotatedSequence annotated{std::move(sequence), {}};
  for (const HumanAct12Variant* kind : annotated.sequence.kinds) annotated.words.push_back(WordsOfVariant(*kind));
  return annotated;
}

}  // namespace

Status WriteAmassLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const bool babel = options.vocabulary == StudioVocabulary::kBabel;
  if (Status wanted = babel ? CheckBabelWords(options.actions) : CheckVariants(options.actions); !wanted) return wanted;
  const std::int64_t subjects = options.subjects > 0 ? options.subjects : kSubjects;
  std::vector<AnnotatedSequence> sequences;
  for (int s = 1; s <= subjects; ++s) {
    for (int n = 1; n <= (options.clips > 0 ? options.clips : kSequences); ++n) {
      sequences.push_back(babel ? PlanBabelSequence(options, s, n, kAmassRateHz)
                                : InBabelWords(PlanSequence(options, s, n, 3, 6, kAmassRateHz)));
    }
  }
  Status done = folder.ForEach(sequences.size(), [&](std::size_t i) -> Status {
    const PlannedSequence& sequence = sequences[i].sequence;
    const Actor& actor = actors[static_cast<std::size_t>(sequence.subject - 1)];
    const Motion motion = PerformScript(sequence.script, actor.subject, actor.skeleton, FrameRate{kAmassRateHz, 1});
    const std::string name = std::string(kDataset) + "/" + sequence.Person() + "/" + TakeOf(sequence) + "_poses.npz";
    const Expected<std::string> bytes = EncodeAmass(AmassOf(motion), name);
    if (!bytes) return Forward(bytes);
    if (Status written = folder.Write("amass/" + name, *bytes); !written) return written;
    const std::string person = std::string(kDataset) + "." + sequence.Person();
    folder.AddTruth(sequence.Person(), "amass/" + person + "/" + person + "." + TakeOf(sequence) + "_poses", motion);
    return {};
  });
  if (!done) return done;
  // The last of five subjects are the validation set, at least one where there are two.
  const std::int64_t last = subjects > 1 ? std::max<std::int64_t>(1, babel ? subjects / 5 : 1) : 0;
  std::vector<BabelSequence> train, val;
  for (std::size_t i = 0; i < sequences.size(); ++i) {
    const bool validates = sequences[i].sequence.subject > subjects - last;
    (validates ? val : train).push_back(AnnotationOf(options, sequences[i], static_cast<std::int64_t>(i) + 1));
  }
  if (Status written = folder.Write("amass/babel_v1.0_release/train.json", EncodeBabel(train)); !written)
    return written;
  return folder.Write("amass/babel_v1.0_release/val.json", EncodeBabel(val));
}

}  // namespace mocurate
