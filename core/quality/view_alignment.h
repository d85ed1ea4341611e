#pragma once

#include <optional>

#include "core/geometry/rigid.h"
#include "core/quality/tracked_points.h"

namespace mocurate {

/// How one tracker's view of a scene lies to another's, and by how much its clock is off.
struct ViewAlignment {
  RigidTransform a_from_b;       ///< metres
  double offset_s = 0.0;         ///< added to a time of b gives that of a; 0 where it is not known
  double offset_sigma_s = 0.0;   ///< one standard deviation
  bool offset_known = false;     ///< surer than half a frame
  double correlation = 0.0;      ///< of the speeds at the offset
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
