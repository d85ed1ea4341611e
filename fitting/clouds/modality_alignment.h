#pragma once

#include <vector>

#include "core/body/capsule_body.h"
#include "core/geometry/rigid.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/costs/pose_state.h"

namespace mocurate {

/// How the clouds of a clip lie to poses that other evidence gave: what a calibration or a clock of its own per kind of
/// cameras leaves between them.
struct ModalityAlignment {
  double apart = 0.0;       ///< m, from the middle of the posed joints to that of the points, median over frames
  double size_ratio = 1.0;  ///< extent of the points over that of the posed body, median
  double near = 0.0;        ///< share of the points within reach of the body, as given
  double near_after = 0.0;  ///< and when moved and read later, or either
  double loss = 1.0;        ///< mean of the points, in [0, 1], as given

  /// One way to take the clouds: moved as a whole, read later, or both.
  struct Taken {
    RigidTransform world_from_clouds;
    double moved = 0.0;               ///< m, that the person's middle moves by it
    double turned = 0.0;              ///< rad
    double late_s = 0.0;              ///< a cloud shows the pose of so long before its stamp
    double moved_sigma = 0.0;         ///< m, standard deviation; of the body's shape nothing is in it
    double clock_offset_sigma = 0.0;  ///< s; large for a motionless person
    double loss = 1.0;
  };
  Taken moved, late, both;
};

/// Registers the clouds (one per frame, empty where there is none) to the body in the state's poses: point to capsule,
/// robust, all `frames` together, over a rigid motion of the clouds, over one delay, and over both. `step_s` between
/// frames; `longest_s`: later or earlier clouds are not believed; `reach`: m. Needs Update of all frames.
ModalityAlignment AlignModalities(const CapsuleBody& body, const PoseState& state,
                                  const std::vector<FusedCloud>& clouds, const std::vector<int>& frames, double step_s,
                                  double longest_s, double reach);

/// The cloud as a rigid motion moves it.
FusedCloud Moved(const FusedCloud& cloud, const RigidTransform& transform);

}  // namespace mocurate
