#pragma once

#include <limits>
#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/triangulation/robust_triangulation.h"

namespace mocurate {

/// One camera's detections of all people, without lens distortion. F frames of the camera, P entries per frame, K
/// keypoints.
struct RigView {
  /// Detections with a confidence below `min_confidence` are unobserved.
  RigView(const KeypointView& view, int keypoint_count, double min_confidence);

  TriangulationView camera;
  std::vector<double> time_s;        ///< (F)
  int people = 0;                    ///< P
  int keypoints = 0;                 ///< K
  std::vector<Vector2d> normalised;  ///< (F,P,K) at depth 1
  std::vector<double> confidence;    ///< (F,P,K) in [0, 1]; 0: unobserved
  std::vector<int> seen;             ///< (F,P) observed keypoints of an entry; 0: no entry

  int frames() const { return static_cast<int>(time_s.size()); }
  /// A copy of frames [begin, end).
  RigView Frames(int begin, int end) const;
  std::size_t Entry(int frame, int person) const { return static_cast<std::size_t>(frame) * people + person; }
  std::size_t Point(int frame, int person, int keypoint) const { return Entry(frame, person) * keypoints + keypoint; }
};

/// Known keypoints of a person in the world.
struct BodyPoints {
  std::vector<Vector3d> position;  ///< (K) metres
  std::vector<char> known;         ///< (K)
  double extent = 0.0;             ///< diagonal of their bounding box, metres

  int KnownCount() const;
  void MeasureExtent();
};

inline constexpr int kLeastKeypoints = 4;  ///< keypoints; fewest that an entry shares with a body or another entry
/// m; distance without a match (numerical).
inline constexpr double kNoMatch = std::numeric_limits<double>::infinity();

/// Distance of a point from a ray, across the line of sight at the depth of the point: metres; kNoMatch behind the
/// camera.
double OffTheRay(const RigView& view, const Vector2d& normalised, const Vector3d& point);

/// Median of OffTheRay over the keypoints that entry and body share; kNoMatch for fewer than `least`.
double EntryDistance(const RigView& view, int frame, int person, const BodyPoints& body, int least);

/// An entry of one frame of a view, as indices into the rig.
struct Sight {
  int view = 0;
  int frame = 0;   ///< of the view
  int person = 0;  ///< entry
};

/// Points nearest to the rays of some entries, weighted by confidence, then reweighted by agreement. A keypoint is
/// known when at least two entries observe it from directions more than 1 degree apart, in front of the cameras.
BodyPoints NearestBody(const std::vector<RigView>& rig, const std::vector<Sight>& sights);

/// Explains why views agree on no person, from rays of entries that pairs of neighbouring views observe at one time.
/// Returns an error kInconsistent with numbers. Causes: too few entries, or none at one time; nearly parallel rays;
/// rays that meet behind the cameras; rays that miss each other.
Error WhyNoPerson(const std::vector<RigView>& rig);

}  // namespace mocurate
