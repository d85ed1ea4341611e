#include "eval/features/yardsticks.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "core/base/random.h"
#include "core/motion/action_parts.h"
#include "core/motion/kinematics.h"
#include "eval/protocols/draws.h"

namespace mocurate {
namespace {

/// One frame: means over all frames of joints about the root, of the root's height, and of rotations, whose mean is the
/// largest eigenvector of the sum of q q^T [Markley 2007]. Bones of a set with rotations are those of its first motion.
Motion MeanPose(const std::vector<Yardsticks::Answer>& clips) {
  const Motion& like = clips.front().motion;
  const int J = like.joint_count();
  JointPositions joints(1, J);
  std::vector<Eigen::Matrix4d> sums(like.joints_only() ? 0 : static_cast<std::size_t>(J), Eigen::Matrix4d::Zero());
  double height = 0.0;
  int frames = 0;
  for (const Yardsticks::Answer& clip : clips) {
    const Motion& motion = clip.motion;
    frames += motion.frame_count();
    for (int f = 0; f < motion.frame_count(); ++f) {
      const Vector3d root = motion.joints.at(f, 0);
      height += root.y();
      for (int j = 0; j < J; ++j) joints.at(0, j) += motion.joints.at(f, j) - root;
      for (std::size_t j = 0; j < sums.size(); ++j) {
        const Eigen::Vector4d q = motion.rotation_at(f, static_cast<int>(j)).coeffs();
        sums[j] += q * q.transpose();
      }
    }
  }
  const Vector3d root(0.0, height / frames, 0.0);
  if (sums.empty()) {
    for (int j = 0; j < J; ++j) joints.at(0, j) = root + joints.at(0, j) / frames;
    return MakeJointsOnly(like.skeleton, like.rate, std::move(joints));
  }
  std::vector<Quaterniond> mean;
  for (const Eigen::Matrix4d& sum : sums) {
    mean.emplace_back(Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(sum).eigenvectors().col(3));
  }
  Motion pose = MakeMotion(like.skeleton, like.rate, {root}, std::move(mean), like.bone_length);
  pose.rotation_reference = like.rotation_reference;
  return pose;
}

Motion StandStill(const Motion& pose, int frames) {
  if (pose.joints_only()) {
    JointPositions joints(frames, pose.joint_count());
    for (int f = 0; f < frames; ++f) {
      for (int j = 0; j < pose.joint_count(); ++j) joints.at(f, j) = pose.joints.at(0, j);
    }
    return MakeJointsOnly(pose.skeleton, pose.rate, std::move(joints));
  }
  std::vector<Quaterniond> rotation;
  for (int f = 0; f < frames; ++f) rotation.insert(rotation.end(), pose.rotation.begin(), pose.rotation.end());
  Motion motion = MakeMotion(pose.skeleton, pose.rate,
                             std::vector<Vector3d>(static_cast<std::size_t>(frames), pose.root_translation.front()),
                             std::move(rotation), pose.bone_length);
  motion.rotation_reference = pose.rotation_reference;
  return motion;
}

std::size_t Drawn(std::size_t count, std::uint64_t seed, const char* purpose) {
  return static_cast<std::size_t>(Random(seed, purpose).Below(count));
}

}  // namespace

Expected<Yardsticks> Yardsticks::Make(Yardstick yardstick, const Dataset& set, const std::set<int>& skipped,
                                      const FeaturesOptions& options) {
  const auto rows = TrainingRows(set, options.split);
  if (!rows) return Forward(rows);
  Yardsticks made;
  made.yardstick_ = yardstick;
  made.names_ = set.labels;
  for (const int row : *rows) {
    const Clip& clip = set.clips[static_cast<std::size_t>(row)];
    const int label = set.LabelIndex(clip.label);
    if (skipped.count(row) > 0 || !clip.motion || label < 0) continue;
    auto motion = TakePart(clip, options.clip_part);
    if (!motion) return Forward(motion);
    for (auto* unused : {&motion->position_cov, &motion->rotation_sigma, &motion->rotation_observed}) unused->clear();
    made.of_label_[label].push_back({clip.id(), std::move(*motion)});
  }
  for (auto& [label, clips] : made.of_label_) {
    made.labels_.push_back(label);
    if (yardstick != Yardstick::kMeanPose) continue;
    clips = {{"mean pose/" + set.labels[static_cast<std::size_t>(label)], MeanPose(clips)}};
  }
  return made;
}

Expected<Yardsticks::Answer> Yardsticks::Of(const MotionRequest& request) const {
  const bool shuffled = yardstick_ == Yardstick::kShuffledLabels && !labels_.empty();
  const int label = shuffled ? labels_[Drawn(labels_.size(), request.seed, "yardstick.label")] : request.label;
  const auto found = of_label_.find(label);
  if (found == of_label_.end()) {
    return Fail(ErrorCode::kInconsistent,
                "no training clip has the label '" + names_[static_cast<std::size_t>(request.label)] + "'",
                "evaluate.yardsticks", "set yardsticks: false, or choose another split");
  }
  const Answer& answer = found->second[Drawn(found->second.size(), request.seed, "yardstick.clip")];
  if (yardstick_ != Yardstick::kMeanPose) return answer;
  return Answer{answer.clip + "/" + std::to_string(request.seed), StandStill(answer.motion, request.frames)};
}

}  // namespace mocurate
