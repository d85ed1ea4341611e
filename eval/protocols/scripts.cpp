#include "eval/protocols/scripts.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "core/base/random.h"
#include "core/motion/action_parts.h"
#include "core/motion/heading.h"
#include "core/motion/operations.h"
#include "eval/protocols/draws.h"

namespace mocurate {
namespace {

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

Expected<std::vector<MotionRequest>> DrawScripts(const Dataset& dataset, const std::vector<int>& rows,
                                                 const FeaturesOptions& options, int repetition) {
  const auto sequences = SequencesOf(dataset, rows);
  if (!sequences) return Forward(sequences);
  const auto seed = static_cast<std::uint64_t>(options.seed);
  const bool chain = options.script == ScriptDraw::kChain;
  const int all = static_cast<int>(rows.size());
  const int count = options.motions == 0 ? all : static_cast<int>(options.motions);
  const std::vector<int> drawn = DrawPositions(all, count, options.replacement, seed, repetition, "scripts");
  Random random(seed, "scripts of repetition", std::to_string(repetition));
  std::vector<MotionRequest> requests;
  for (int i = 0; i < (chain ? count : static_cast<int>(drawn.size())); ++i) {
    const auto row =
        static_cast<std::size_t>(rows[static_cast<std::size_t>(drawn[static_cast<std::size_t>(i) % drawn.size()])]);
    const Clip& clip = dataset.clips[row];
    MotionRequest request;
    const std::uint64_t high = random.Next();
    request.seed = (high << 32) | random.Next();
    request.bone_length = clip.motion->bone_length;
    request.source_clip = clip.id();
    if (chain) {
      request.label = DrawOf(sequences->classes, random);
      request.frames = sequences->usual[static_cast<std::size_t>(request.label)][1];
      request.script = DrawChain(*sequences, request.label, static_cast<int>(options.steps), random);
      request.script.resize(static_cast<std::size_t>(options.step));  // steps after the scored one are not requested
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
  int begin = request.previous ? 0 : request.frames;
  for (int k = 0; k + 1 < step; ++k) {
    const ScriptStep& done = request.script[static_cast<std::size_t>(k)];
    begin += done.transition_frames + done.frames;
  }
  const ScriptStep& wanted = request.script[static_cast<std::size_t>(step - 1)];
  const Motion& before = begin > 0 ? answer : *request.previous->motion;
  const int anchor = begin > 0 ? begin - 1 : before.frame_count() - 1;
  Clip clip;
  clip.motion = answer;
  clip.rate = answer.rate;
  const int action = begin + wanted.transition_frames;
  Clip cut = part == ClipPart::kTransition ? *Cut(clip, begin, action) : *Cut(clip, action, action + wanted.frames);
  Transform(FacingFront(before, anchor), cut);
  return *std::move(cut.motion);
}

}  // namespace mocurate
