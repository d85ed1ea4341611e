#pragma once

#include <optional>

#include "core/motion/clip.h"

namespace mocurate {

/// Each operation acts on *all* fields of a clip: motion with its optional fields, evidence, segments, identity. Spans
/// are frames of the clip's motion or tracks.

/// Frames [begin, end). Segments are cut and shifted, empty ones dropped; identity spans move along; all evidence keeps
/// one clock, of which frame `begin` is the zero. Error kUsage if the span is empty or outside.
Expected<Clip> Cut(const Clip& clip, int begin_frame, int end_frame);

/// The longest stretch of a clip's motion without frames that are inferred throughout (gaps.h); nothing where there are
/// no such frames. Error kInconsistent: all of them are.
Expected<std::optional<Clip>> WithoutInferred(const Clip& clip);

/// To another rate by time: rotations by slerp, positions linearly, covariances and states from the nearer frame; the
/// first frame stays, the last is the last one not after the old last frame. Same rate gives the same values exactly.
/// Tracks are taken at the new times too (linear between two observed frames, else missing, confidence 0), depth views
/// by the nearest picture.
Clip Resample(const Clip& clip, FrameRate rate);

/// Exactly `frame_count` >= 2 frames, first and last kept, evenly spaced in time. For recognisers.
Motion ResampleToCount(const Motion& motion, int frame_count);

/// Mirror image in the sagittal plane (x -> -x of the canonical world): joints change sides through
/// Skeleton::joints[].mirror, rotations and translations are reflected (frames of partners map by
/// Skeleton::Reflection). Tracks swap the names of their sides. Depth pictures stay as they are: their cameras are
/// reflected, which gives them a negative fx. Twice is the identity.
Clip Mirror(const Clip& clip);

/// x -> world_from_clip * x for everything that has a place: motion, evidence, cameras; canonical_from_source is
/// updated.
void Transform(const RigidTransform& world_from_clip, Clip& clip);
/// The same of a motion alone.
void Transform(const RigidTransform& world_from_motion, Motion& motion);

/// C <- map C map^T for every covariance (xx xy xz yy yz zz, six numbers each); `map` a rotation or a reflection.
void RotateCovariances(const Matrix3d& map, std::vector<float>& covariances);

/// For each joint of `target` the joint of `source` that is it; -1 for one without a counterpart. (target J) Arms and
/// legs by how they hang from elbows and knees (LimbsOf), for one name means other joints in other trees; the trunk,
/// where both arms hang from it by collars, by how far along joints lie; all else by names, then by the synonyms of
/// `source`, then by those of `target`, among the joints left over.
std::vector<int> MatchJoints(const Skeleton& source, const Skeleton& target);

/// Unfitted tracks as a joints-only motion on a skeleton: the baseline that a fit is compared with. Points are matched
/// by name and synonym. Missing observations are interpolated linearly in time and held at both ends; their states are
/// those of GapStates. A root that no track gives is the midpoint of the hips (state kInferred). Error kInconsistent
/// names the joints that no track gives.
Expected<Motion> MotionFromTracks(const JointTracks& tracks, const SkeletonPtr& skeleton, FrameRate rate,
                                  double max_gap_s);

}  // namespace mocurate
