#pragma once

#include <optional>
#include <vector>

#include "core/base/error.h"
#include "fitting/clouds/observed_rig.h"

namespace mocurate {

/// Metres between a view's person and the others'; at larger distances their surfaces do not meet.
inline constexpr double kAside = 0.12;

/// Offset of each view's person from that of the others, in the world: between the centres of the points, moved a
/// little behind the surface. Zero when no moment shows both.
std::vector<Vector3d> AsideOf(const ObservedRig& rig, const std::vector<Camera>& cameras);

/// A view with wrong depths, by an offset or by a scale; both are equivalent at one distance.
struct WrongDepths {
  std::size_t view = 0;
  double factor = 1.0;    ///< that corrects them
  double too_long = 0.0;  ///< metres at the person; negative: too short
  double loss = 0.0;      ///< of the rig (MeanLoss) with corrected depths
};

/// The view whose person has the largest offset from the others, if along its line of sight. Includes the factor on its
/// depths with the lowest loss. Unlike a moved camera, wrong depths also change the size of the person. Errors of
/// ReadFrame.
Expected<std::optional<WrongDepths>> FindWrongDepths(const DepthRigSampler& sampler, const std::vector<int>& delays,
                                                     const ObservedRig& rig, const std::vector<Camera>& cameras);

/// The views with the depths of one times `factor`.
std::vector<DepthView> WithDepths(std::vector<DepthView> views, std::size_t view, double factor);

}  // namespace mocurate
