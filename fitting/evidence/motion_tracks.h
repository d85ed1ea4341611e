#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "core/motion/skeleton.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/options.h"

namespace mocurate {

/// The tracks renamed to `names`, in their order; tracks without a name are dropped.
JointTracks SelectedTracks(const JointTracks& tracks, const std::vector<std::optional<std::string>>& names);

/// The joints of a given motion as tracks of the joints of another skeleton; unknown names are excluded. Samples have
/// confidence 1, interpolated ones 0. Error kInconsistent when the two have no joint in common.
Expected<JointTracks> TracksOfMotion(const Motion& motion, const Skeleton& skeleton);

/// Evidence of a clip for the joints of `skeleton`: its tracks, else the joints of its given motion. Excluded names of
/// tracks go to `excluded`. Confidences are scaled so that the most confident tenth of the samples has 1. Errors of
/// MapTracks and TracksOfMotion, with the clip's id; kInconsistent for a clip that has neither.
Expected<SkeletonTracks> TracksOfClip(const Clip& clip, const SkeletonPtr& skeleton, OtherJoints other,
                                      std::vector<std::string>* excluded = nullptr);

/// Key of the provenance under which ingest leaves the skeleton that a source declares.
inline constexpr const char* kSourceSkeleton = "source_skeleton";

/// Key of the provenance under which ingest leaves the markers that a source declares, as JSON: a list of {"point",
/// "joint", "offset", "spread"}.
inline constexpr const char* kMarkers = "markers";

/// A tracker's points and their places on a body.
struct TrackerPoints {
  SkeletonPtr tracker;             ///< its skeleton; null: the tracks' names are those of the body's joints
  std::vector<PointPlace> places;  ///< of which the body has the joints
  bool markers = false;            ///< points on the skin that the source declares; others are left out
  std::string unknown{};           ///< markers of joints that the body lacks: "LKNE (left_kne)"
};

/// Of the clip's tracks on `body`. A built-in skeleton of the source that declares the places of its points is a
/// tracker; on a tracker's own skeleton its points are its joints.
TrackerPoints TrackerPointsOf(const Clip& clip, const Skeleton& body);

/// Name of the joint that represents a tracker's point on a body.
std::string TrackedName(const std::string& point);

/// `skeleton` with an additional joint at the end, marked `landmark`, for each point that its tracker places on it.
SkeletonPtr WithTrackerPoints(const SkeletonPtr& skeleton, const Clip& clip);
/// The same without them, with the rest offsets that `body` has.
SkeletonPtr WithoutTrackerPoints(const SkeletonPtr& body);

/// The tracks renamed to the joints of `body`: its own joints, else the tracker's points on it. Other points are
/// excluded.
JointTracks OnBodyOf(const TrackerPoints& points, const JointTracks& tracks, const Skeleton& body);

/// Standard deviation of the places of points on `body`, metres per axis (J), 0 for joints; empty without such points.
std::vector<double> PlaceSigmas(const TrackerPoints& points, const Skeleton& body);

}  // namespace mocurate
