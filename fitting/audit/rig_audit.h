#pragma once

#include <string>
#include <vector>

#include "fitting/association/associate.h"
#include "fitting/association/rig_view.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/options.h"

namespace mocurate {

/// A rig, and how it had to be taken to agree with itself.
struct AuditedRig {
  std::vector<RigView> rig;  ///< with clocks and poses corrected where options say so; a camera that was moved during
                             ///< the take is two views, the later one named "NAME from frame N"
  std::vector<RigFault> faults;
  bool corrected = false;
  /// What people may be off by because several cameras may be the ones that stand elsewhere, m^2 per axis and between
  /// axes: how far the places that were taken move them.
  Matrix3d place_covariance = Matrix3d::Zero();
  std::string not_audited;  ///< what was not looked for, and why; empty: all was, or was not to be
  /// (views, spans) median pixel error of a camera's detections in equal spans of the take, before anything is
  /// corrected; 0 where it observes no person.
  std::vector<std::vector<double>> residual_px;
};

/// Clocks and places of cameras and views that list left as right throughout, from everybody that views agree on. At 32
/// moments of the take the points of all views are compared with what each sees: clocks by RefineClocks, places by
/// FindMove, sides by FindSidesThroughout; what explains most is taken over, and the rest is asked again, until nothing
/// does. `names` (K) of the keypoints. Fewer than three views are taken as they are.
AuditedRig AuditRig(const std::vector<RigView>& rig, const Association& take, const std::vector<std::string>& names,
                    const KeypointFitOptions& options);

}  // namespace mocurate
