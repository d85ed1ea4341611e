#pragma once

#include <optional>
#include <vector>

#include "core/base/error.h"
#include "fitting/clouds/observed_rig.h"

namespace mocurate {

/// Metres that a view's person may lie beside the others'; farther apart their surfaces do not meet.
inline constexpr double kAside = 0.12;

/// How far each view has the person beside where the others have her, in the world: of the middles of what they see,
/// put a little deeper than the surface. Zero where no moment shows both.
std::vector<Vector3d> AsideOf(const ObservedRig& rig, const std::vector<Camera>& cameras);

/// A view whose depths are wrong by an offset, or a scale, which at one person's distance is the same.
struct WrongDepths {
  std::size_t view = 0;
  double factor = 1.0;    ///< that corrects them
  double too_long = 0.0;  ///< metres at the person; negative: too short
  double loss = 0.0;      ///< of the rig (MeanLoss) with corrected depths
};

/// The view that has the person farthest beside the others, if that is along its own line of sight: with the factor on
/// its depths with which it contradicts them least. Unlike a camera that was moved, wrong depths make the person larger
/// or smaller too. Errors of ReadFrame.
Expected<std::optional<WrongDepths>> FindWrongDepths(const DepthRigSampler& sampler, const std::vector<int>& late,
                                                     const ObservedRig& rig, const std::vector<Camera>& cameras);

/// The same views, depths of one times `factor`.
std::vector<DepthView> WithDepths(std::vector<DepthView> views, std::size_t view, double factor);

}  // namespace mocurate
