#pragma once

#include <optional>

#include "canon/trim/body_description.h"

namespace mocurate {

/// The posture (3 J) in which a recording is still most often: the one with the largest sum, over separate still
/// moments, of the time spent near it weighted by slowness, at most 0.6 s of each. A posture held once, however long,
/// is one moment. Nothing where that sum is below 0.6 s or 6 % of the time away from it: the body is never at rest.
std::optional<Eigen::RowVectorXd> RestPosture(const BodyDescription& body);

/// Distance of a body from rest.
struct Unrest {
  bool rests = false;     ///< whether there is a rest posture
  Eigen::VectorXd value;  ///< (S) sqrt((distance from the rest posture / 0.1 m)^2 + (movement / 0.15 m/s)^2), about 1
                          ///< and less at rest; the largest number throughout where there is no rest posture
};

Unrest MeasureUnrest(const BodyDescription& body);

}  // namespace mocurate
