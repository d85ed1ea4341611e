#pragma once

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

/// A step towards the offset that lays the moving points on each other, and how sure it is.
struct ClockStep {
  double seconds = 0.0;  ///< to be added to the offset
  double sigma = 0.0;    ///< seconds, one standard deviation by leaving out an eighth of the frames at a time
  bool known = false;    ///< something moves, and as both see it: velocities correlate by 0.3 at least
};

/// Least squares of the positions over time, linear in the offset (each point's own bias between the trackers
/// removed), for points observed by both.
ClockStep RefineClock(const TrackedPoints& a, const TrackedPoints& b, const RigidTransform& a_from_b, double offset_s);

/// The points of b at the times of a, frame by frame: linear between two frames that see a point. `frame` is that of a.
struct PointAt {
  bool seen = false;
  double confidence = 0.0;  ///< the lower of both
  Vector3d place = Vector3d::Zero();
};
PointAt PointWhen(const TrackedPoints& b, double time_s, int point);

}  // namespace mocurate
