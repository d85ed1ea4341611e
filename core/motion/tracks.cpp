#include "core/motion/operations.h"

#include "core/motion/gaps.h"
#include "core/motion/kinematics.h"

namespace mocurate {
namespace {

/// Copies track k to joint j; between observed frames positions are linear in time, beyond the ends they are constant.
/// False if the point is never observed.
bool CopyTrack(const JointTracks& tracks, int k, int j, double max_gap_s, Motion& motion) {
  const int frames = motion.frame_count();
  const int points = static_cast<int>(tracks.names.size());
  std::vector<int> seen;
  std::vector<bool> observed;
  for (int f = 0; f < frames; ++f) {
    observed.push_back(tracks.confidence[static_cast<std::size_t>(f) * points + k] > 0.0);
    if (observed.back()) seen.push_back(f);
  }
  if (seen.empty()) return false;
  const std::vector<JointState> states = GapStates(observed, tracks.time_s, motion.rate.FrameTime(1), max_gap_s);
  for (int f = 0; f < frames; ++f) motion.state[static_cast<std::size_t>(f) * motion.joint_count() + j] = states[f];
  std::size_t next = 0;
  for (int f = 0; f < frames; ++f) {
    while (next < seen.size() && seen[next] < f) ++next;
    if (next < seen.size() && seen[next] == f) {
      motion.joints.at(f, j) = tracks.positions.at(f, k);
      continue;
    }
    if (next == 0 || next == seen.size()) {
      motion.joints.at(f, j) = tracks.positions.at(next == 0 ? seen.front() : seen.back(), k);
      continue;
    }
    const int before = seen[next - 1];
    const int after = seen[next];
    const double share = (tracks.time_s[f] - tracks.time_s[before]) / (tracks.time_s[after] - tracks.time_s[before]);
    motion.joints.at(f, j) = (1.0 - share) * tracks.positions.at(before, k) + share * tracks.positions.at(after, k);
  }
  return true;
}

}  // namespace

Expected<Motion> MotionFromTracks(const JointTracks& tracks, const SkeletonPtr& skeleton, FrameRate rate,
                                  double max_gap_s) {
  const int frames = tracks.positions.frames;
  Motion motion = MakeJointsOnly(skeleton, rate, JointPositions(frames, skeleton->joint_count()));
  motion.state.assign(static_cast<std::size_t>(frames) * skeleton->joint_count(), JointState::kObserved);
  std::vector<bool> found(skeleton->joint_count(), false);
  for (std::size_t k = 0; k < tracks.names.size(); ++k) {
    if (const auto joint = skeleton->FindJoint(tracks.names[k])) {
      found[*joint] = CopyTrack(tracks, static_cast<int>(k), *joint, max_gap_s, motion);
    }
  }
  const auto hips = skeleton->Hips();
  if (!found[0] && hips && found[(*hips)[0]] && found[(*hips)[1]]) {
    for (int f = 0; f < frames; ++f) {
      motion.joints.at(f, 0) = 0.5 * (motion.joints.at(f, (*hips)[0]) + motion.joints.at(f, (*hips)[1]));
      motion.state[static_cast<std::size_t>(f) * motion.joint_count()] = JointState::kInferred;
    }
    found[0] = true;
  }
  std::string missing;
  for (int j = 0; j < skeleton->joint_count(); ++j) {
    if (!found[j]) missing += (missing.empty() ? "" : ", ") + skeleton->joints[j].name;
  }
  if (!missing.empty()) {
    return Fail(ErrorCode::kInconsistent,
                "no track gives the joints " + missing + " of skeleton '" + skeleton->name + "'", "canon.skeleton",
                "choose a skeleton whose joints the source tracks, or fit first");
  }
  return motion;
}

}  // namespace mocurate
