#include "fitting/evidence/motion_tracks.h"

#include <algorithm>
#include <string>

#include "core/motion/gaps.h"
#include "core/motion/operations.h"
#include "fitting/evidence/tracker_points.h"

namespace mocurate {
namespace {

Error Of(const Clip& clip, Error error) {
  error.where = clip.id() + (error.where.empty() ? "" : ": " + error.where);
  return error;
}

/// Tracks of joints that the skeleton has, or of its landmarks; the names of the others.
JointTracks TracksOfSkeleton(const JointTracks& tracks, const Skeleton& skeleton, std::vector<std::string>& unknown) {
  std::vector<std::size_t> known;
  JointTracks kept;
  kept.time_s = tracks.time_s;
  for (std::size_t k = 0; k < tracks.names.size(); ++k) {
    const std::string& name = tracks.names[k];
    const bool landmark = std::any_of(skeleton.landmarks.begin(), skeleton.landmarks.end(),
                                      [&](const Landmark& other) { return other.name == name; });
    if (!landmark && !skeleton.FindJoint(name)) {
      unknown.push_back(name);
      continue;
    }
    known.push_back(k);
    kept.names.push_back(name);
  }
  const int frames = tracks.positions.frames;
  kept.positions = JointPositions(frames, static_cast<int>(known.size()));
  for (int f = 0; f < frames; ++f) {
    for (std::size_t k = 0; k < known.size(); ++k) {
      kept.positions.at(f, static_cast<int>(k)) = tracks.positions.at(f, static_cast<int>(known[k]));
      const std::size_t at = f * tracks.names.size() + known[k];
      kept.confidence.push_back(tracks.confidence[at]);
      if (tracks.rotation.empty()) continue;
      kept.rotation.push_back(tracks.rotation[at]);
      kept.rotation_confidence.push_back(tracks.rotation_confidence[at]);
    }
  }
  return kept;
}

/// (F*J) Samples of the motion that are evidence: not interpolated ones, which the fit interpolates itself, nor frames
/// that are inferred throughout. Inferred joints of other frames are, where the motion states how uncertain they are.
std::vector<bool> EvidenceOf(const Motion& motion) {
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  std::vector<bool> evidence(joints * static_cast<std::size_t>(motion.frame_count()), true);
  const std::vector<bool> inferred = InferredFrames(motion);
  const bool uncertain = !motion.rotation_sigma.empty() || !motion.position_cov.empty();
  for (std::size_t at = 0; at < motion.state.size(); ++at) {
    const bool is_inferred = inferred[at / joints] || (motion.state[at] == JointState::kInferred && !uncertain);
    evidence[at] = !is_inferred && motion.state[at] != JointState::kInterpolated;
  }
  return evidence;
}

/// World rotations of the motion's joints `common`; none for end joints, whose rotation in a motion is arbitrary.
void AddRotations(const Motion& motion, const std::vector<int>& common, const std::vector<bool>& evidence,
                  JointTracks& tracks) {
  const Skeleton& skeleton = *motion.skeleton;
  const std::vector<std::vector<int>> children = skeleton.Children();
  std::vector<Quaterniond> world(skeleton.joints.size());
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      const int parent = skeleton.joints[j].parent;
      world[j] = parent < 0 ? motion.rotation_at(f, j) : (world[parent] * motion.rotation_at(f, j)).normalized();
    }
    for (const int joint : common) {
      tracks.rotation.push_back(world[joint]);
      const std::size_t at = static_cast<std::size_t>(f) * skeleton.joints.size() + static_cast<std::size_t>(joint);
      const bool none = children[joint].empty() || !evidence[at];
      tracks.rotation_confidence.push_back(none ? 0.0 : 1.0);
    }
  }
}

}  // namespace

Expected<JointTracks> TracksOfMotion(const Motion& motion, const Skeleton& skeleton) {
  const std::vector<int> match = MatchJoints(*motion.skeleton, skeleton);
  std::vector<int> common;
  JointTracks tracks;
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    if (match[joint] < 0) continue;
    common.push_back(match[joint]);
    tracks.names.push_back(skeleton.joints[joint].name);
  }
  if (common.empty()) {
    return Fail(ErrorCode::kInconsistent,
                "the skeletons '" + motion.skeleton->name + "' and '" + skeleton.name + "' have no joint in common",
                "motion", "add synonyms to the skeleton, or choose another");
  }
  tracks.positions = JointPositions(motion.frame_count(), static_cast<int>(common.size()));
  tracks.confidence.assign(tracks.positions.xyz.size() / 3, 1.0);
  const std::vector<bool> evidence = EvidenceOf(motion);
  for (int f = 0; f < motion.frame_count(); ++f) {
    tracks.time_s.push_back(motion.rate.FrameTime(f));
    for (int k = 0; k < tracks.positions.joints; ++k) {
      tracks.positions.at(f, k) = motion.joints.at(f, common[k]);
      const std::size_t at = static_cast<std::size_t>(f) * motion.skeleton->joints.size();
      if (!evidence[at + static_cast<std::size_t>(common[k])])
        tracks.confidence[static_cast<std::size_t>(f) * common.size() + k] = 0.0;
    }
  }
  if (!motion.joints_only()) AddRotations(motion, common, evidence, tracks);
  return tracks;
}

namespace {

/// Confidences only compare samples of one clip. They are scaled so that the 90th percentile is 1, whatever scale a
/// tracker uses.
void RelateConfidences(SkeletonTracks& tracks) {
  std::vector<double> there;
  for (const double confidence : tracks.confidence) {
    if (confidence > 0.0) there.push_back(confidence);
  }
  if (there.empty()) return;
  const auto high = there.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(there.size() - 1));
  std::nth_element(there.begin(), high, there.end());
  const double usual = *high;
  for (double& confidence : tracks.confidence) confidence = std::min(1.0, confidence / usual);
}

}  // namespace

Expected<SkeletonTracks> TracksOfClip(const Clip& clip, const SkeletonPtr& skeleton, OtherJoints other,
                                      std::vector<std::string>* excluded) {
  Expected<JointTracks> given;
  const TrackerPoints points = TrackerPointsOf(clip, *skeleton);
  const JointTracks* tracks = clip.evidence.tracks ? &*clip.evidence.tracks : nullptr;
  std::vector<std::string> unknown;
  if (points.tracker) {
    given = OnBodyOf(points, *tracks, *skeleton);
    tracks = &*given;
  }
  if (tracks != nullptr && other == OtherJoints::kLeaveOut) {
    given = JointTracks(TracksOfSkeleton(*tracks, *skeleton, unknown));
    tracks = &*given;
  }
  if (tracks == nullptr && clip.motion) {
    given = TracksOfMotion(*clip.motion, *skeleton);
    if (!given) return tl::unexpected<Error>(Of(clip, given.error()));
    tracks = &*given;
  }
  if (tracks == nullptr) {
    return Fail(ErrorCode::kInconsistent, "the clip has no joint tracks", clip.id(),
                !clip.evidence.keypoint_views.empty() ? "set fitting.method to keypoints for 2-D keypoints"
                : !SurfaceTimes(clip.evidence).empty()
                    ? "set fitting.method to point_clouds for depth views and point clouds"
                    : "set fitting.method to what its source gives");
  }
  Expected<SkeletonTracks> mapped = MapTracks(*tracks, skeleton);
  if (!mapped) return tl::unexpected<Error>(Of(clip, mapped.error()));
  RelateConfidences(*mapped);
  mapped->place_sigma = PlaceSigmas(points, *skeleton);
  if (excluded != nullptr) *excluded = std::move(unknown);
  return mapped;
}

}  // namespace mocurate
