#include "ingest/sources/damaged_frames.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/motion/kinematics.h"

namespace mocurate {

Expected<std::vector<DamagedFrame>> BridgeFrames(const std::vector<int>& damaged, int frames, const std::string& name) {
  std::vector<DamagedFrame> bridged;
  if (frames > 0 && static_cast<int>(damaged.size()) >= frames) {
    return Fail(ErrorCode::kInconsistent, "none of " + Counted(frames, "frame") + " has valid values", name,
                "repair the file, or leave it out", Reason::kNoValidSamples);
  }
  for (std::size_t at = 0; at < damaged.size();) {
    std::size_t end = at + 1;
    while (end < damaged.size() && damaged[end] == damaged[end - 1] + 1) ++end;
    const int first = damaged[at], last = damaged[end - 1];
    const bool from = first > 0, to = last + 1 < frames;
    for (int f = first; f <= last; ++f) {
      const int before = from ? first - 1 : last + 1, after = to ? last + 1 : first - 1;
      const double share = before < after ? static_cast<double>(f - before) / (after - before) : 0.0;
      bridged.push_back({f, before, after, share});
    }
    at = end;
  }
  return bridged;
}

void Bridge(const std::vector<DamagedFrame>& bridged, int joints, std::vector<Vector3d>& root,
            std::vector<Quaterniond>& rotation) {
  const auto at = [](int frame) { return static_cast<std::size_t>(frame); };
  for (const DamagedFrame& damaged : bridged) {
    root[at(damaged.frame)] =
        (1.0 - damaged.share) * root[at(damaged.before)] + damaged.share * root[at(damaged.after)];
    for (int j = 0; j < joints; ++j) {
      const auto of = [&](int frame) {
        return at(frame) * static_cast<std::size_t>(joints) + static_cast<std::size_t>(j);
      };
      rotation[of(damaged.frame)] =
          rotation[of(damaged.before)].slerp(damaged.share, rotation[of(damaged.after)]).normalized();
    }
  }
}

void MarkBridged(const std::vector<DamagedFrame>& bridged, Motion& motion, std::vector<Finding>& findings) {
  if (bridged.empty()) return;
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  motion.state.assign(static_cast<std::size_t>(motion.frame_count()) * joints, JointState::kObserved);
  std::vector<bool> is_bridged(static_cast<std::size_t>(motion.frame_count()), false);
  for (const DamagedFrame& damaged : bridged) {
    is_bridged[static_cast<std::size_t>(damaged.frame)] = true;
    std::fill_n(motion.state.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(damaged.frame) * joints),
                joints, JointState::kInterpolated);
  }
  for (Finding& finding : findings) {
    const int end = finding.frame_end;
    bool all = finding.action == FindingAction::kDropped && finding.frame_begin < end && end <= motion.frame_count();
    for (int f = finding.frame_begin; all && f < end; ++f) all = is_bridged[static_cast<std::size_t>(f)];
    if (all) finding.action = FindingAction::kInterpolated;
  }
}

Status AddMotion(const std::vector<int>& damaged, const SkeletonPtr& skeleton, const std::vector<double>& bone_length,
                 std::vector<Vector3d> root, std::vector<Quaterniond> rotation, const std::string& name,
                 IngestedClip& ingested) {
  const FrameRate rate = ingested.clip.rate;
  const auto bridged = BridgeFrames(damaged, static_cast<int>(root.size()), name);
  if (!bridged) return Forward(bridged);
  const auto joints = static_cast<std::size_t>(skeleton->joint_count());
  Bridge(*bridged, skeleton->joint_count(), root, rotation);
  for (std::size_t j = 0; j < joints; ++j) MakeSignContinuous(rotation.data() + j, root.size(), joints);
  ingested.clip.motion = MakeMotion(skeleton, rate, std::move(root), std::move(rotation), bone_length);
  MarkBridged(*bridged, *ingested.clip.motion, ingested.findings);
  return {};
}

}  // namespace mocurate
