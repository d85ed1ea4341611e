#pragma once

#include <optional>
#include <vector>

#include "core/geometry/rigid.h"
#include "core/quality/tracked_points.h"

namespace mocurate {

/// How much later one clock is than another. `seconds` is added to a time of b to get that of a.
struct ClockOffset {
  double seconds = 0.0;
  double correlation = 0.0;  ///< of the speeds there, -1 to 1
};

/// Offsets that maximise the cross-correlation of the speeds of the same points, each about its own mean. Returns the
/// highest maximum and those at least 0.7 as high (periodic motion), best first, with parabolic interpolation between
/// frames. Speeds do not depend on rotation: the cameras need not be aligned. Both have the same points and evenly
/// spaced frames of one rate. At most `most_s` either way; empty where nothing moves or fewer than 12 frames overlap.
std::vector<ClockOffset> CorrelateSpeeds(const TrackedPoints& a, const TrackedPoints& b, double most_s);

/// The points of b at the times of a, frame by frame: linear between two frames that see a point. `frame` is that of a.
struct PointAt {
  bool seen = false;
  double confidence = 0.0;  ///< the lower of both
  Vector3d place = Vector3d::Zero();
};
PointAt PointWhen(const TrackedPoints& b, double time_s, int point);

/// How one tracker's view of a scene lies to another's, and by how much its clock is off.
struct ViewAlignment {
  RigidTransform a_from_b;       ///< metres
  double offset_s = 0.0;         ///< added to a time of b gives that of a; 0 where it is not known
  double offset_sigma_s = 0.0;   ///< one standard deviation
  bool offset_known = false;     ///< surer than half a frame
  double median = 0.0;           ///< metres between the same points after the alignment
  double mirrored_median = 0.0;  ///< the same with b mirrored
  double share = 0.0;            ///< of the pairs within three times the median
  int pairs = 0;                 ///< points observed well by both
  bool Mirrored() const;         ///< b fits as its mirror image and not as it is
};

/// From the points that both trackers follow, without any calibration. Initial clock offsets come from the
/// cross-correlation of speeds (CorrelateSpeeds). From each of them, robust Procrustes over all frames and points that
/// both observe well alternates with RefineClock. The result with the smallest distances is returned. Empty where both
/// observe fewer than 12 frames or 60 points, or where these lie on a line. `most_offset_s`: largest clock offset.
std::optional<ViewAlignment> AlignViews(const TrackedPoints& a, const TrackedPoints& b, double most_offset_s);

}  // namespace mocurate
