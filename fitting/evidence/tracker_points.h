#pragma once

#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "core/motion/point_places.h"

namespace mocurate {

/// Key of the provenance under which ingest leaves the skeleton that a source declares.
inline constexpr const char* kSourceSkeleton = "source_skeleton";

/// What a tracker's points are on a body.
struct TrackerPoints {
  SkeletonPtr tracker;             ///< its skeleton; none: the tracks' names are those of the body's joints
  std::vector<PointPlace> places;  ///< that the body has the joints for
};

/// Of the clip's tracks on `body`. A built-in skeleton of the source that says where its points lie is a tracker; on
/// the skeleton of a tracker its points are what they are called.
TrackerPoints TrackerPointsOf(const Clip& clip, const Skeleton& body);

/// Name of the joint that stands for a tracker's point on a body.
std::string TrackedName(const std::string& point);

/// `skeleton` with a joint more at the end, marked `landmark`, for each of the points that its tracker places on it.
SkeletonPtr WithTrackerPoints(const SkeletonPtr& skeleton, const Clip& clip);
/// The same without them, with the rest offsets that `body` has.
SkeletonPtr WithoutTrackerPoints(const SkeletonPtr& body);

/// The tracks as `body` calls their points: its own joints, else the tracker's points on it. Points that lie elsewhere
/// than `body` has a joint for are left out.
JointTracks OnBodyOf(const TrackerPoints& points, const JointTracks& tracks, const Skeleton& body);

/// How far off the places of points on `body` may be, metres per axis (J), 0 for joints; empty without such points.
std::vector<double> PlaceSpreads(const TrackerPoints& points, const Skeleton& body);

}  // namespace mocurate
