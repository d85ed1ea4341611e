#include "eval/protocols/draws.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "core/base/random.h"
#include "core/motion/action_parts.h"
#include "core/motion/heading.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"

namespace mocurate {
namespace {

/// Bone lengths as the generator's kinematics defines them: distances in the first frame.
std::vector<double> FirstFrameBones(const Motion& motion) {
  std::vector<Vector3d> joints(motion.joint_count());
  for (int j = 0; j < motion.joint_count(); ++j) joints[j] = motion.joints.at(0, j);
  return BoneLengths(*motion.skeleton, joints.data());
}

/// The first frame with its root at the origin.
std::vector<double> FirstPose(const Motion& motion) {
  std::vector<double> pose;
  for (int j = 0; j < motion.joint_count(); ++j) {
    const Vector3d position = motion.joints.at(0, j) - motion.joints.at(0, 0);
    pose.insert(pose.end(), {position.x(), position.y(), position.z()});
  }
  return pose;
}

/// Frames of a part of a sample; nothing for the whole, or where the clip is not a sample.
std::optional<int> FramesOfPart(const Clip& clip, ClipPart part) {
  if (part == ClipPart::kWhole) return std::nullopt;
  const auto parts = PartsOf(clip);
  if (!parts) return std::nullopt;
  return parts->frames[part == ClipPart::kTransition ? 1 : 2];
}

/// Statistics of the actions in samples.
struct Sequences {
  std::vector<int> classes;                ///< that have samples
  std::map<int, std::vector<int>> after;   ///< classes that follow a class
  std::map<int, std::vector<int>> before;  ///< classes that precede one
  std::vector<std::array<int, 2>> usual;   ///< mean frames of transition and action of each class
};

Expected<Sequences> SequencesOf(const Dataset& dataset, const std::vector<int>& rows) {
  std::set<int> classes;
  std::map<int, std::set<int>> after, before;
  std::vector<std::array<double, 3>> sums(dataset.labels.size() + 1, {0.0, 0.0, 0.0});
  const std::set<int> chosen(rows.begin(), rows.end());
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    const auto parts = PartsOf(dataset.clips[i]);
    if (!parts) return Forward(parts);
    const int action = dataset.LabelIndex(parts->label[2]), previous = dataset.LabelIndex(parts->label[0]);
    if (action < 0) continue;
    for (const std::size_t at : {static_cast<std::size_t>(action), dataset.labels.size()}) {
      sums[at][0] += parts->frames[1];
      sums[at][1] += parts->frames[2];
      sums[at][2] += 1.0;
    }
    if (chosen.count(static_cast<int>(i)) == 0) continue;
    classes.insert(action);
    if (previous < 0) continue;
    after[previous].insert(action);
    before[action].insert(previous);
  }
  Sequences sequences;
  sequences.classes.assign(classes.begin(), classes.end());
  for (const auto& [label, next] : after) sequences.after[label].assign(next.begin(), next.end());
  for (const auto& [label, last] : before) sequences.before[label].assign(last.begin(), last.end());
  for (std::size_t c = 0; c < dataset.labels.size(); ++c) {
    const std::array<double, 3>& sum = sums[c][2] > 0.0 ? sums[c] : sums.back();
    if (sum[2] == 0.0) return Fail(ErrorCode::kInconsistent, "no clip of the set is labelled", "evaluate.rows");
    sequences.usual.push_back(
        {std::max(1, static_cast<int>(sum[0] / sum[2])), std::max(1, static_cast<int>(sum[1] / sum[2]))});
  }
  return sequences;
}

template <class List>
int DrawOf(const List& list, Random& random) {
  return list[static_cast<std::size_t>(random.Below(list.size()))];
}

/// One of the labels in `known` for `label`, else one of all.
int DrawNeighbour(const std::map<int, std::vector<int>>& known, int label, const std::vector<int>& all,
                  Random& random) {
  const auto found = known.find(label);
  return DrawOf(found == known.end() ? all : found->second, random);
}

std::vector<ScriptStep> DrawChain(const Sequences& sequences, int first, int steps, Random& random) {
  std::vector<ScriptStep> script;
  for (int label = first; steps > 0; --steps) {
    label = DrawNeighbour(sequences.after, label, sequences.classes, random);
    const std::array<int, 2>& usual = sequences.usual[static_cast<std::size_t>(label)];
    script.push_back({label, usual[0], usual[1]});
  }
  return script;
}

}  // namespace

Expected<const Split*> ChooseSplit(const Dataset& dataset, const std::string& name) {
  if (name.empty()) return dataset.splits.empty() ? nullptr : &dataset.splits.front();
  if (const Split* split = dataset.FindSplit(name)) return split;
  std::string known;
  for (const Split& split : dataset.splits) known += (known.empty() ? "" : ", ") + split.name;
  return Fail(ErrorCode::kConfig, "the dataset has no split '" + name + "'", "evaluate.split", "it has: " + known);
}

Expected<std::vector<int>> RowsOfPart(const Dataset& dataset, RealPart part, const std::string& name) {
  const auto split = ChooseSplit(dataset, name);
  if (!split) return Forward(split);
  std::vector<int> rows(dataset.clips.size());
  std::iota(rows.begin(), rows.end(), 0);
  if (part != RealPart::kAll && *split != nullptr) {
    rows = part == RealPart::kTest ? (*split)->test : (*split)->train;
    if (part == RealPart::kTrain) rows.insert(rows.end(), (*split)->validation.begin(), (*split)->validation.end());
  }
  if (!rows.empty()) return rows;
  return Fail(ErrorCode::kInconsistent,
              std::string("no clip is in the ") + (part == RealPart::kTest ? "test" : "training") + " part",
              "evaluate.real", "choose evaluate.real: all, or a split whose parts have clips");
}

Expected<std::vector<int>> TrainingRows(const Dataset& dataset, const std::string& name) {
  const auto split = ChooseSplit(dataset, name);
  if (!split) return Forward(split);
  if (*split != nullptr && !(*split)->train.empty()) return (*split)->train;
  std::vector<int> rows(dataset.clips.size());
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

std::vector<int> DrawPositions(int size, int count, bool replacement, std::uint64_t seed, int repetition,
                               const std::string& purpose) {
  std::vector<int> positions(static_cast<std::size_t>(size));
  std::iota(positions.begin(), positions.end(), 0);
  if (count == 0) return positions;
  Random random(seed, purpose, std::to_string(repetition));
  if (replacement) {
    positions.resize(static_cast<std::size_t>(count));
    for (int& position : positions) position = static_cast<int>(random.Below(static_cast<std::uint64_t>(size)));
    return positions;
  }
  const auto wanted = static_cast<std::size_t>(std::min(count, size));
  for (std::size_t i = 0; i < wanted; ++i) std::swap(positions[i], positions[i + random.Below(positions.size() - i)]);
  positions.resize(wanted);
  return positions;
}

std::vector<int> DrawPerLabel(const std::vector<int>& labels, int per_label, std::uint64_t seed, int repetition,
                              const std::string& purpose) {
  std::vector<int> members(
      labels.empty() ? 0 : static_cast<std::size_t>(1 + *std::max_element(labels.begin(), labels.end())));
  std::vector<int> chosen;
  for (const int position : DrawPositions(static_cast<int>(labels.size()), static_cast<int>(labels.size()), false, seed,
                                          repetition, purpose)) {
    const int label = labels[static_cast<std::size_t>(position)];
    if (label >= 0 && members[static_cast<std::size_t>(label)]++ < per_label) chosen.push_back(position);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::vector<MotionRequest> DrawRequests(const Dataset& dataset, const std::vector<int>& rows,
                                        const std::vector<int>& training, const FeaturesOptions& options, int frames,
                                        int repetition) {
  const auto seed = static_cast<std::uint64_t>(options.seed);
  const int all = static_cast<int>(options.motions == 0 ? static_cast<std::int64_t>(rows.size()) : options.motions);
  const std::vector<int> real =
      DrawPositions(static_cast<int>(rows.size()), all, options.replacement, seed, repetition, "reference");
  // Without replacement, ACTOR generates as many motions as it draws real ones.
  const int count = options.replacement ? all : static_cast<int>(real.size());
  std::set<int> present;
  for (const int row : rows) {
    present.insert(std::max(0, dataset.LabelIndex(dataset.clips[static_cast<std::size_t>(row)].label)));
  }
  const std::vector<int> classes(present.begin(), present.end());
  std::map<int, std::vector<int>> of_label;
  for (const int row : training) {
    of_label[std::max(0, dataset.LabelIndex(dataset.clips[static_cast<std::size_t>(row)].label))].push_back(row);
  }
  Random random(seed, "requests", std::to_string(repetition)), poses(seed, "first poses", std::to_string(repetition));
  const auto clip_of_label = [&](int label) {
    const auto of = of_label.find(label);  // a class may have no training clip
    const std::vector<int>& members = of == of_label.end() ? training : of->second;
    return &dataset.clips[static_cast<std::size_t>(members[poses.Below(members.size())])];
  };
  std::vector<MotionRequest> requests(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < requests.size(); ++i) {
    MotionRequest& request = requests[i];
    const Clip& like = dataset.clips[static_cast<std::size_t>(rows[static_cast<std::size_t>(real[i % real.size()])])];
    request.label = options.labels == LabelDraw::kUniform ? classes[random.Below(classes.size())]
                                                          : std::max(0, dataset.LabelIndex(like.label));
    request.frames = FramesOfPart(like, options.clip_part).value_or(frames);
    request.seed = (static_cast<std::uint64_t>(random.Next()) << 32) | random.Next();
    const Clip& source = dataset.clips[static_cast<std::size_t>(training[random.Below(training.size())])];
    request.bone_length = FirstFrameBones(*source.motion);
    request.source_clip = source.id();
    request.first_pose = FirstPose(*clip_of_label(request.label)->motion);
  }
  return requests;
}

Expected<std::vector<MotionRequest>> DrawScripts(const Dataset& dataset, const std::vector<int>& rows,
                                                 const std::vector<int>& training, const FeaturesOptions& options,
                                                 int repetition) {
  const auto sequences = SequencesOf(dataset, rows);
  if (!sequences) return Forward(sequences);
  const auto seed = static_cast<std::uint64_t>(options.seed);
  const bool chain = options.script == ScriptDraw::kChain;
  const int all = static_cast<int>(rows.size());
  const int count = options.motions == 0 ? all : static_cast<int>(options.motions);
  const std::vector<int> drawn = DrawPositions(all, count, options.replacement, seed, repetition, "scripts");
  Random random(seed, "scripts of repetition", std::to_string(repetition));
  Random bodies(seed, "bodies of scripts", std::to_string(repetition));
  std::vector<MotionRequest> requests;
  for (int i = 0; i < (chain ? count : static_cast<int>(drawn.size())); ++i) {
    const auto row =
        static_cast<std::size_t>(rows[static_cast<std::size_t>(drawn[static_cast<std::size_t>(i) % drawn.size()])]);
    const Clip& clip = dataset.clips[row];
    MotionRequest request;
    const std::uint64_t high = random.Next();
    request.seed = (high << 32) | random.Next();
    // A motion that continues a sample keeps its bones; every other one has those of a training clip.
    const bool continues = options.script == ScriptDraw::kAfterSample;
    const Clip& body = continues ? clip : dataset.clips[static_cast<std::size_t>(DrawOf(training, bodies))];
    request.bone_length = body.motion->bone_length;
    request.source_clip = body.id();
    if (chain) {
      request.label = DrawOf(sequences->classes, random);
      request.frames = sequences->usual[static_cast<std::size_t>(request.label)][1];
      request.script = DrawChain(*sequences, request.label, static_cast<int>(options.steps) - 1, random);
      // Steps after the scored one are not requested.
      request.script.resize(static_cast<std::size_t>(options.step) - 1);
      requests.push_back(std::move(request));
      continue;
    }
    const auto parts = PartsOf(clip);
    if (!parts) return Forward(parts);
    const int action = dataset.LabelIndex(parts->label[2]);
    if (action < 0 || parts->frames[0] < 1) {
      return Fail(ErrorCode::kInconsistent, "the clip is not a sample with a class and a previous action", clip.id());
    }
    request.label = dataset.LabelIndex(parts->label[0]);
    request.frames = parts->frames[0];
    request.script = {{action, parts->frames[1], parts->frames[2]}};
    if (options.script == ScriptDraw::kAfterSample) {
      auto previous = Cut(clip, 0, parts->frames[0]);
      if (!previous) return Forward(previous);
      request.previous_clip = clip.id();
      request.previous = std::make_shared<const Clip>(std::move(*previous));
    } else if (request.label < 0) {
      request.label = DrawNeighbour(sequences->before, action, sequences->classes, random);
    }
    requests.push_back(std::move(request));
  }
  return requests;
}

Motion StepOfAnswer(const Motion& answer, const MotionRequest& request, int step, ClipPart part) {
  Clip clip;
  clip.motion = answer;
  clip.rate = answer.rate;
  if (step == 0) return *std::move(Cut(clip, 0, request.frames)->motion);
  int begin = request.previous ? 0 : request.frames;
  for (int k = 0; k + 1 < step; ++k) {
    const ScriptStep& done = request.script[static_cast<std::size_t>(k)];
    begin += done.transition_frames + done.frames;
  }
  const ScriptStep& wanted = request.script[static_cast<std::size_t>(step - 1)];
  const Motion& before = begin > 0 ? answer : *request.previous->motion;
  const int anchor = begin > 0 ? begin - 1 : before.frame_count() - 1;
  const int action = begin + wanted.transition_frames;
  Clip cut = part == ClipPart::kTransition ? *Cut(clip, begin, action) : *Cut(clip, action, action + wanted.frames);
  Transform(FacingFront(before, anchor), cut);
  return *std::move(cut.motion);
}

}  // namespace mocurate
