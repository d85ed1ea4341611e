#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fitting/association/associate.h"
#include "fitting/association/rig_view.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/audit/rig_samples.h"
#include "fitting/options.h"

namespace mocurate {

/// Clocks, poses and sides of a rig as audited.
struct RigEstimate {
  std::optional<RigModel> model;     ///< as corrected; none: not audited
  std::vector<std::size_t> suspect;  ///< views of which some have another pose than calibrated; which is ambiguous
  /// (views, takes) mean decrease of the cost of a moment by the view's clock, pose and sides; empty for an unchanged
  /// view.
  std::vector<std::vector<std::optional<double>>> gain;
};

/// A rig, with the corrections that make its views agree.
struct AuditedRig {
  std::vector<RigView> rig;  ///< with clocks and poses corrected where the options allow it; a camera that was moved
                             ///< during the take is two views, the later one named "NAME from frame N"
  std::vector<RigFault> faults;
  bool corrected = false;
  /// Uncertainty of people's positions when the moved camera is ambiguous, m^2 per axis and between axes: the shift
  /// that the chosen poses cause.
  Matrix3d place_covariance = Matrix3d::Zero();
  RigEstimate estimate;
  std::string not_audited;  ///< which tests were impossible, and why; empty: none
  /// (views, spans) median pixel error of a camera's detections in equal spans of the take, before corrections; 0
  /// without detections.
  std::vector<std::vector<double>> residual_px;
};

/// Estimates clocks, camera poses and exchanged sides from all people that views agree on. At 32 moments of the take,
/// points of all views are compared with each view's detections: clocks by RefineClocks, poses by FindMove, sides by
/// FindSidesThroughout. The change that explains most is applied and the rest tested again, until nothing improves.
/// `names` (K) of the keypoints. Fewer than three views stay unchanged.
/// `takes`: the moments of several takes of one rig are audited together, 32 of each of up to four takes.
AuditedRig AuditRig(const std::vector<RigView>& rig, const Association& take, const std::vector<std::string>& names,
                    const KeypointFitOptions& options, const TakeStarts& takes = {});

}  // namespace mocurate
