#include "eval/protocols/draws.h"

#include <numeric>

#include "core/base/random.h"
#include "core/motion/kinematics.h"

namespace mocurate {
namespace {

std::vector<int> RowsOf(const Dataset& dataset, RealPart part, const Split* split) {
  if (part != RealPart::kAll && split != nullptr) {
    if (part == RealPart::kTest) return split->test;
    std::vector<int> rows = split->train;
    rows.insert(rows.end(), split->validation.begin(), split->validation.end());
    return rows;
  }
  std::vector<int> rows(dataset.clips.size());
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

/// Bone lengths as the generator's kinematics reads them: distances in the first frame.
std::vector<double> FirstFrameBones(const Motion& motion) {
  std::vector<Vector3d> joints(motion.joint_count());
  for (int j = 0; j < motion.joint_count(); ++j) joints[j] = motion.joints.at(0, j);
  return BoneLengths(*motion.skeleton, joints.data());
}

}  // namespace

Expected<const Split*> ChooseSplit(const Dataset& dataset, const std::string& name) {
  if (name.empty()) return dataset.splits.empty() ? nullptr : &dataset.splits.front();
  if (const Split* split = dataset.FindSplit(name)) return split;
  std::string known;
  for (const Split& split : dataset.splits) known += (known.empty() ? "" : ", ") + split.name;
  return Fail(ErrorCode::kConfig, "the dataset has no split '" + name + "'", "evaluate.split", "it has: " + known);
}

Expected<RealSet> ChooseReal(const Dataset& dataset, RealPart part, const std::string& split_name) {
  const auto split = ChooseSplit(dataset, split_name);
  if (!split) return Forward(split);
  RealSet real;
  std::vector<int> members(dataset.labels.size(), 0);
  for (const int row : RowsOf(dataset, part, *split)) {
    const int label = dataset.LabelIndex(dataset.clips[row].label);
    if (label < 0) continue;
    real.rows.push_back(row);
    real.labels.push_back(label);
    ++members[label];
  }
  for (std::size_t c = 0; c < members.size(); ++c) {
    if (members[c] > 0) continue;
    return Fail(ErrorCode::kInconsistent,
                "class '" + dataset.labels[c].name + "' has no real motion in the chosen part", "evaluate.real",
                "choose evaluate.real: all, or a split whose parts hold every class");
  }
  return real;
}

std::vector<int> DrawReal(const RealSet& real, int count, std::uint64_t seed, int repetition, const char* purpose) {
  Random random(seed, purpose, std::to_string(repetition));
  std::vector<int> drawn(count);
  for (int& position : drawn) position = static_cast<int>(random.Below(real.rows.size()));
  return drawn;
}

std::vector<MotionRequest> DrawRequests(const Dataset& dataset, const RealSet& real, const std::vector<int>& drawn_real,
                                        const EvaluateOptions& options, int frames, int repetition) {
  Random random(static_cast<std::uint64_t>(options.seed), "requests", std::to_string(repetition));
  std::vector<MotionRequest> requests(static_cast<std::size_t>(options.motions));
  for (std::size_t i = 0; i < requests.size(); ++i) {
    MotionRequest& request = requests[i];
    request.label = options.labels == LabelDraw::kUniform ? static_cast<int>(random.Below(dataset.labels.size()))
                                                          : real.labels[drawn_real[i % drawn_real.size()]];
    request.frames = frames;
    request.seed = (static_cast<std::uint64_t>(random.Next()) << 32) | random.Next();
    const Clip& source = dataset.clips[real.rows[random.Below(real.rows.size())]];
    request.bone_length = FirstFrameBones(*source.motion);
    request.source_clip = source.id();
  }
  return requests;
}

}  // namespace mocurate
