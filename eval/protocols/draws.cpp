#include "eval/protocols/draws.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "core/base/random.h"
#include "core/motion/action_parts.h"
#include "core/motion/kinematics.h"

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
                                        const FeaturesOptions& options, int frames, int repetition) {
  const auto seed = static_cast<std::uint64_t>(options.seed);
  const int count = static_cast<int>(options.motions == 0 ? static_cast<std::int64_t>(rows.size()) : options.motions);
  const std::vector<int> real =
      DrawPositions(static_cast<int>(rows.size()), count, options.replacement, seed, repetition, "reference");
  std::set<int> present;
  for (const int row : rows) {
    present.insert(std::max(0, dataset.LabelIndex(dataset.clips[static_cast<std::size_t>(row)].label)));
  }
  const std::vector<int> classes(present.begin(), present.end());
  std::map<int, std::vector<int>> of_label;
  for (const int row : rows) {
    of_label[std::max(0, dataset.LabelIndex(dataset.clips[static_cast<std::size_t>(row)].label))].push_back(row);
  }
  Random random(seed, "requests", std::to_string(repetition)), poses(seed, "first poses", std::to_string(repetition));
  const auto clip_of_label = [&](int label) {
    const std::vector<int>& members = of_label.at(label);
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
    const Clip& source = dataset.clips[static_cast<std::size_t>(rows[random.Below(rows.size())])];
    request.bone_length = FirstFrameBones(*source.motion);
    request.source_clip = source.id();
    request.first_pose = FirstPose(*clip_of_label(request.label)->motion);
  }
  return requests;
}

}  // namespace mocurate
