#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/formats/amass.h"
#include "core/formats/babel.h"
#include "ingest/synthetic/action_parts.h"
#include "ingest/synthetic/babel_plan.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/sequence_plan.h"

namespace mocurate {
namespace {

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
  return Digits(sequence.subject, 2) + "_" + Digits(sequence.number, 2);
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

/// Labels of all actions, of the transitions between them and of standing; unsorted, and sometimes overlapping, as in
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
    annotation.labels.push_back(LabelOfSpan({"stand", {"stand"}}, {0, script.actions.front().begin}, random));
  }
  for (std::size_t k = 0; k < script.actions.size(); ++k) {
    annotation.labels.push_back(
        LabelOfSpan(annotated.words[k], {script.actions[k].begin, script.actions[k].end}, random));
    if (k >= ways.size()) continue;
    annotation.labels.push_back(LabelOfSpan({"transition", {"transition"}}, ways[k], random));
    const int rest = script.actions[k + 1].begin;
    if (rest > ways[k].end) annotation.labels.push_back(LabelOfSpan({"stand", {"stand"}}, {ways[k].end, rest}, random));
  }
  for (std::size_t i = annotation.labels.size(); i > 1; --i) {
    std::swap(annotation.labels[i - 1], annotation.labels[random.Below(i)]);
  }
  BabelSequence babel;
  babel.babel_sid = sid;
  babel.key = std::to_string(sid);
  babel.url = Digits(static_cast<int>(sid), 6) + ".mp4";
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
    ClipIdentity identity;
    identity.source = "amass";
    identity.person = std::string(kDataset) + "." + sequence.Person();
    identity.recording = std::string(kDataset) + "." + sequence.Person() + "." + TakeOf(sequence) + "_poses";
    identity.end_frame = motion.frame_count();
    folder.AddTruth(sequence.Person(), identity.id(), motion);
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
