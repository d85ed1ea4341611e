#pragma once

#include <vector>

#include "core/body/capsule_body.h"
#include "core/geometry/rigid.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/terms/pose_state.h"

namespace mocurate {

/// Alignment of a clip's clouds with poses from another modality: the offset that separate calibrations or clocks
/// leave.
struct ModalityAlignment {
  double apart = 0.0;       ///< m, from the centre of the posed joints to that of the points, median over frames
  double size_ratio = 1.0;  ///< extent of the points over that of the posed body, median
  double near = 0.0;        ///< share of the points within reach of the body, as given
  double near_after = 0.0;  ///< share after translation, delay, or both
  double loss = 1.0;        ///< mean over the points, in [0, 1], as given

  /// A correction of the clouds: rigid motion, delay, or both.
  struct Taken {
    RigidTransform world_from_clouds;
    double moved = 0.0;               ///< m, translation of the person's centre
    double turned = 0.0;              ///< rad
    double late_s = 0.0;              ///< a cloud shows the pose this long before its stamp
    double moved_sigma = 0.0;         ///< m, standard deviation; without body shape errors
    double clock_offset_sigma = 0.0;  ///< s, standard deviation; large for a motionless person
    double loss = 1.0;
  };
  Taken moved, late, both;
};

/// Registers the clouds (one per frame, empty without points) to the body in the state's poses: point to capsule,
/// robust, over all `frames`. Points near limbs that are not `known` (J) do not count. Estimates a rigid motion of the
/// clouds, a delay, and both. `step_s`: between frames; `longest_s`: limit of the delay; `reach`: m. Needs Update of
/// all frames.
ModalityAlignment AlignModalities(const CapsuleBody& body, const PoseState& state, const std::vector<bool>& known,
                                  const std::vector<FusedCloud>& clouds, const std::vector<int>& frames, double step_s,
                                  double longest_s, double reach);

/// The cloud after a rigid motion.
FusedCloud Moved(const FusedCloud& cloud, const RigidTransform& transform);

}  // namespace mocurate
