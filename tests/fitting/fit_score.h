#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "core/motion/kinematics.h"
#include "fitting/fit_result.h"
#include "tests/fitting/studio_clips.h"

namespace mocurate {

/// Errors of fits against the truth, means over joints and frames. Rotations count on identifiable axes only. A joint
/// with two or more children in different directions counts its full rotation. Any other counts the direction of the
/// bone to its child, if that is at least 6 cm long.
struct FitScore {
  double joint_sum = 0.0, seen_sum = 0.0, hidden_sum = 0.0;  // metres
  std::int64_t joint_count = 0, seen_count = 0, hidden_count = 0;
  double full_sum = 0.0, bone_sum = 0.0;  // radians
  std::int64_t full_count = 0, bone_count = 0;
  std::int64_t one = 0, two = 0, whitened = 0;
  std::vector<double> by_joint;
  std::vector<bool> only;  ///< (J) joints whose position errors count; empty: all
  int frames = 0;

  void Add(const FitResult& fit, const StudioClip& clip) { Add(fit, clip, 0, fit.motion.frame_count()); }

  /// Frames [begin, end).
  void Add(const FitResult& fit, const StudioClip& clip, int begin, int end) {
    const Motion& motion = fit.motion;
    frames += end - begin;
    by_joint.resize(static_cast<std::size_t>(motion.joint_count()), 0.0);
    for (int f = begin; f < end; ++f) {
      for (int j = 0; j < motion.joint_count(); ++j) {
        if (only.empty() || only[static_cast<std::size_t>(j)]) AddJoint(motion, clip, f, j);
      }
      AddRotations(motion, clip.truth, f);
    }
  }

  double joint_mm() const { return 1e3 * joint_sum / static_cast<double>(joint_count); }
  double seen_mm() const { return 1e3 * seen_sum / static_cast<double>(seen_count); }
  double hidden_mm() const { return 1e3 * hidden_sum / static_cast<double>(hidden_count); }
  double full_deg() const { return kDegrees * full_sum / static_cast<double>(full_count); }
  double bone_deg() const { return kDegrees * bone_sum / static_cast<double>(bone_count); }
  double rotation_deg() const {
    return kDegrees * (full_sum + bone_sum) / static_cast<double>(full_count + bone_count);
  }
  double within_one() const { return static_cast<double>(one) / static_cast<double>(whitened); }
  double within_two() const { return static_cast<double>(two) / static_cast<double>(whitened); }

 private:
  static constexpr double kDegrees = 57.29577951308232;
  static constexpr double kShortestBone = 0.06;

  void AddJoint(const Motion& motion, const StudioClip& clip, int f, int j) {
    const std::size_t at = static_cast<std::size_t>(f) * motion.joint_count() + static_cast<std::size_t>(j);
    const Vector3d error = motion.joints.at(f, j) - clip.truth.joints.at(f, j);
    joint_sum += error.norm();
    ++joint_count;
    by_joint[static_cast<std::size_t>(j)] += error.norm();
    const bool good =
        clip.tracks.seen(f, j) && (clip.tracks.positions.at(f, j) - clip.truth.joints.at(f, j)).norm() < 0.12;
    (good ? seen_sum : hidden_sum) += error.norm();
    ++(good ? seen_count : hidden_count);
    if (motion.position_cov.empty()) return;
    const Eigen::LLT<Matrix3d> root(FromSixNumbers(motion.position_cov.data() + 6 * at));
    const Vector3d white = root.matrixL().solve(error);
    one += (white.array().abs() < 1.0).count();
    two += (white.array().abs() < 2.0).count();
    whitened += 3;
  }

  static std::vector<Quaterniond> GlobalRotations(const Motion& motion, int frame) {
    std::vector<Vector3d> joints(static_cast<std::size_t>(motion.joint_count()));
    std::vector<Quaterniond> global(joints.size());
    ForwardKinematics(*motion.skeleton, motion.root_translation[static_cast<std::size_t>(frame)],
                      &motion.rotation_at(frame, 0), motion.bone_length, joints.data(), global.data());
    return global;
  }

  void AddRotations(const Motion& motion, const Motion& truth, int f) {
    const auto children = truth.skeleton->Children();
    const auto fitted = GlobalRotations(motion, f);
    const auto actual = GlobalRotations(truth, f);
    for (std::size_t j = 0; j < children.size(); ++j) {
      if (children[j].size() >= 2) {
        full_sum += AngleBetween(fitted[j], actual[j]);
        ++full_count;
        continue;
      }
      for (const int child : children[j]) {
        if (truth.bone_length[static_cast<std::size_t>(child)] < kShortestBone) continue;
        const Vector3d a = motion.joints.at(f, child) - motion.joints.at(f, static_cast<int>(j));
        const Vector3d b = truth.joints.at(f, child) - truth.joints.at(f, static_cast<int>(j));
        bone_sum += std::atan2(a.cross(b).norm(), a.dot(b));
        ++bone_count;
      }
    }
  }
};

/// Samples whose sides are exchanged, and how many of them a fit exchanged back.
struct SwapScore {
  int exchanged_samples = 0;
  int corrected = 0;
  int mistaken = 0;

  void Add(const FitResult& fit, const StudioClip& clip) {
    for (std::size_t i = 0; i < clip.exchanged.size(); ++i) {
      const bool repaired = fit.motion.state[i] == JointState::kRepaired;
      const bool exchanged = clip.exchanged[i] && clip.tracks.confidence[i] > 0.0;
      exchanged_samples += exchanged ? 1 : 0;
      corrected += exchanged && repaired ? 1 : 0;
      mistaken += !clip.exchanged[i] && repaired ? 1 : 0;
    }
  }
};

}  // namespace mocurate
