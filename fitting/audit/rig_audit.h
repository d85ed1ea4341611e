#pragma once

#include <string>
#include <vector>

#include "core/base/finding.h"
#include "fitting/association/associate.h"
#include "fitting/association/rig_view.h"
#include "fitting/options.h"

namespace mocurate {

/// Something wrong with a rig, its calibration or its files.
struct RigFault {
  std::string code;  ///< "camera_clock_off", "camera_moved", "cameras_exchanged", "calibration_unit", "keypoint_order",
                     ///< "view_swaps_sides"
  std::string camera;   ///< which; empty: the rig
  std::string limb;     ///< that is meant; empty: none
  int frame_begin = 0;  ///< [begin, end) of the take; both 0: all of it
  int frame_end = 0;
  double value = 0.0;       ///< of the code: ms, mm, share of entries that agree, factor, mean departure, margin
  double confidence = 0.0;  ///< [0, 1]
  bool corrected = false;
  std::string message;
};

Finding FindingOf(const RigFault& fault);

/// [{"code", "camera", "frames", "value", "confidence", "corrected"}], one line: what a clip's provenance keeps.
inline constexpr const char* kRigAudit = "rig_audit";
std::string FaultsText(const std::vector<RigFault>& faults);

/// A rig, and how it had to be taken to agree with itself.
struct AuditedRig {
  std::vector<RigView> rig;  ///< with clocks and poses corrected where options say so; a camera that was moved during
                             ///< the take is two views, the later one named "NAME from frame N"
  std::vector<RigFault> faults;
  bool corrected = false;
  std::string not_audited;  ///< what was not looked for, and why; empty: all was, or was not to be
  /// (views, spans) median pixel error of a camera's detections in equal spans of the take, before anything is
  /// corrected; 0 where it sees nobody.
  std::vector<std::vector<double>> residual_px;
};

/// Clocks and places of cameras, from everybody that views agree on. At 32 moments of the take the points of all views
/// are compared with what each sees: clocks by RefineClocks, places by FindMove; what explains most is taken over, and
/// the rest is asked again, until nothing does. Fewer than three views are taken as they are.
AuditedRig AuditRig(const std::vector<RigView>& rig, const Association& take, const KeypointFitOptions& options);

}  // namespace mocurate
