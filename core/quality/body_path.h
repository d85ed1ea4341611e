#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/quality/tracked_points.h"

namespace mocurate {

/// A person as mechanics sees one: metres, y up, one entry a frame.
struct BodyPath {
  std::vector<Vector3d> centre;                 ///< of mass
  std::array<std::vector<Vector3d>, 2> foot;    ///< left, right: between ankle and toe
  std::vector<std::vector<Vector3d>> limb_end;  ///< observed wrists and ankles, relative to the middle of the hips
  double leg = 0.0;                             ///< hip to ankle along the bones

  int frames() const { return static_cast<int>(centre.size()); }
};

/// Hips, knees, ankles and shoulders must be observed in nearly all frames (98 %), at a constant frame rate; short gaps
/// are interpolated linearly. Segment masses after de Leva (1996), hands and feet included in their limbs. Empty where
/// that fails or for fewer than 12 frames.
std::optional<BodyPath> PathOfBody(const TrackedPoints& points);

/// Second differences over `lag` frames on either side, per frame^2: the mean acceleration of that time, weighted like
/// a tent. Entry i is of frame i + lag.
std::vector<Vector3d> Accelerations(const std::vector<Vector3d>& path, int lag);

/// Standard deviation of white noise that explains all third differences of a path along `axis`: fast motion counts as
/// noise too, never the other way round.
double MostNoise(const std::vector<Vector3d>& path, const Vector3d& axis);

}  // namespace mocurate
