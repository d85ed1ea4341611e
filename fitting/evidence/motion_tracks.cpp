#include "fitting/evidence/motion_tracks.h"

#include <optional>
#include <string>

namespace mocurate {
namespace {

Error Of(const Clip& clip, Error error) {
  error.where = clip.id() + (error.where.empty() ? "" : ": " + error.where);
  return error;
}

}  // namespace

Expected<JointTracks> TracksOfMotion(const Motion& motion, const Skeleton& skeleton) {
  // Of several joints that are one joint of the skeleton (by synonyms), the one that has its very name.
  std::vector<int> giver(skeleton.joints.size(), -1);
  for (int j = 0; j < motion.joint_count(); ++j) {
    const std::string& name = motion.skeleton->joints[j].name;
    const std::optional<int> joint = skeleton.FindJoint(name);
    if (joint && (giver[*joint] < 0 || name == skeleton.joints[*joint].name)) giver[*joint] = j;
  }
  std::vector<int> common;
  JointTracks tracks;
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    if (giver[joint] < 0) continue;
    common.push_back(giver[joint]);
    tracks.names.push_back(skeleton.joints[joint].name);
  }
  if (common.empty()) {
    return Fail(ErrorCode::kInconsistent,
                "the skeletons '" + motion.skeleton->name + "' and '" + skeleton.name + "' have no joint in common",
                "motion", "add synonyms to the skeleton, or choose another");
  }
  tracks.positions = JointPositions(motion.frame_count(), static_cast<int>(common.size()));
  tracks.confidence.assign(tracks.positions.xyz.size() / 3, 1.0);
  for (int f = 0; f < motion.frame_count(); ++f) {
    tracks.time_s.push_back(motion.rate.FrameTime(f));
    for (int k = 0; k < tracks.positions.joints; ++k) tracks.positions.at(f, k) = motion.joints.at(f, common[k]);
  }
  return tracks;
}

Expected<SkeletonTracks> TracksOfClip(const Clip& clip, const SkeletonPtr& skeleton) {
  Expected<JointTracks> given;
  const JointTracks* tracks = clip.evidence.tracks ? &*clip.evidence.tracks : nullptr;
  if (tracks == nullptr && clip.motion) {
    given = TracksOfMotion(*clip.motion, *skeleton);
    if (!given) return tl::unexpected<Error>(Of(clip, given.error()));
    tracks = &*given;
  }
  if (tracks == nullptr) {
    return Fail(ErrorCode::kInconsistent, "the clip has no joint tracks", clip.id(),
                "set fitting.method to point_clouds for depth views");
  }
  Expected<SkeletonTracks> mapped = MapTracks(*tracks, skeleton);
  if (!mapped) return tl::unexpected<Error>(Of(clip, mapped.error()));
  return mapped;
}

}  // namespace mocurate
