#include "eval/features/yardsticks.h"

#include <algorithm>
#include <map>
#include <memory>

#include "core/base/random.h"
#include "core/motion/action_parts.h"
#include "core/motion/kinematics.h"
#include "core/motion/request.h"
#include "eval/protocols/draws.h"

namespace mocurate {
namespace {

using OfLabel = std::map<int, std::vector<Motion>>;  // training clips by index of their label

/// One frame: means over all frames of the motions.
Motion MeanPose(const std::vector<Motion>& motions) {
  const Motion& like = motions.front();
  const int J = like.joint_count();
  JointPositions joints(1, J);
  std::vector<Eigen::Vector4d> rotation(like.joints_only() ? 0 : static_cast<std::size_t>(J), Eigen::Vector4d::Zero());
  double height = 0.0;
  int frames = 0;
  for (const Motion& motion : motions) {
    frames += motion.frame_count();
    for (int f = 0; f < motion.frame_count(); ++f) {
      const Vector3d root = motion.joints.at(f, 0);
      height += root.y();
      for (int j = 0; j < J; ++j) joints.at(0, j) += motion.joints.at(f, j) - root;
      for (std::size_t j = 0; j < rotation.size(); ++j) {
        const Eigen::Vector4d q = motion.rotation_at(f, static_cast<int>(j)).coeffs();
        rotation[j] += q.dot(rotation[j]) < 0.0 ? Eigen::Vector4d(-q) : q;
      }
    }
  }
  const Vector3d root(0.0, height / frames, 0.0);
  if (rotation.empty()) {
    for (int j = 0; j < J; ++j) joints.at(0, j) = root + joints.at(0, j) / frames;
    return MakeJointsOnly(like.skeleton, like.rate, std::move(joints));
  }
  std::vector<Quaterniond> mean;
  for (const Eigen::Vector4d& sum : rotation) mean.push_back(Quaterniond(sum).normalized());
  return MakeMotion(like.skeleton, like.rate, {root}, std::move(mean), like.bone_length);
}

Motion StandStill(const Motion& pose, int frames) {
  if (pose.joints_only()) {
    JointPositions joints(frames, pose.joint_count());
    for (int f = 0; f < frames; ++f) {
      std::copy(pose.joints.xyz.begin(), pose.joints.xyz.end(),
                joints.xyz.begin() + static_cast<std::ptrdiff_t>(f) * 3 * pose.joint_count());
    }
    return MakeJointsOnly(pose.skeleton, pose.rate, std::move(joints));
  }
  std::vector<Quaterniond> rotation;
  for (int f = 0; f < frames; ++f) rotation.insert(rotation.end(), pose.rotation.begin(), pose.rotation.end());
  return MakeMotion(pose.skeleton, pose.rate,
                    std::vector<Vector3d>(static_cast<std::size_t>(frames), pose.root_translation.front()),
                    std::move(rotation), pose.bone_length);
}

}  // namespace

Expected<AnswerRequests> AnswersOf(Yardstick yardstick, const Dataset& set, const FeaturesOptions& options) {
  const auto rows = TrainingRows(set, options.split);
  if (!rows) return Forward(rows);
  auto clips = std::make_shared<OfLabel>();
  for (const int row : *rows) {
    const Clip& clip = set.clips[static_cast<std::size_t>(row)];
    if (!clip.motion || clip.label.empty()) continue;
    auto motion = TakePart(clip, options.clip_part);
    if (!motion) return Forward(motion);
    for (auto* unused : {&motion->position_cov, &motion->rotation_sigma, &motion->rotation_observed}) unused->clear();
    (*clips)[set.LabelIndex(clip.label)].push_back(std::move(*motion));
  }
  std::vector<int> labels;
  for (auto& [label, motions] : *clips) {
    labels.push_back(label);
    if (yardstick == Yardstick::kMeanPose) motions = {MeanPose(motions)};
  }
  const auto drawn = [](const auto& from, const Random& random) {
    Random copy = random;
    return from[static_cast<std::size_t>(copy.Below(from.size()))];
  };
  return AnswerRequests(
      [=, names = set.labels](const std::vector<MotionRequest>& requests) -> Expected<std::vector<Motion>> {
        std::vector<Motion> answers;
        for (const MotionRequest& request : requests) {
          const int label = yardstick == Yardstick::kShuffledLabels && !labels.empty()
                                ? drawn(labels, Random(request.seed, "yardstick.label"))
                                : request.label;
          const auto of_label = clips->find(label);
          if (of_label == clips->end()) {
            return Fail(ErrorCode::kInconsistent,
                        "no training clip has the label '" + names[static_cast<std::size_t>(request.label)] + "'",
                        "evaluate.yardsticks", "set yardsticks: false, or choose another split");
          }
          const Motion motion = drawn(of_label->second, Random(request.seed, "yardstick.clip"));
          answers.push_back(yardstick == Yardstick::kMeanPose ? StandStill(motion, request.frames) : motion);
        }
        return answers;
      });
}

}  // namespace mocurate
