#pragma once

#include <string>
#include <vector>

#include "core/base/finding.h"

namespace mocurate {

/// Views that contradict others; corrected: they are excluded.
inline constexpr const char* kContradictingView = "views_disagree";

/// Something wrong with a rig, its calibration or its files.
struct RigFault {
  std::string code;  ///< "camera_clock_off", "camera_moved", "cameras_exchanged", "calibration_unit", "keypoint_order",
                     ///< "view_swaps_sides", "views_swap_sides", "views_disagree", "view_mirrored", "keypoint_scale",
                     ///< "cameras_in_one_place"
  std::string camera;   ///< which; empty: the rig
  std::string limb;     ///< that is meant; empty: none
  int frame_begin = 0;  ///< [begin, end) of the take; both 0: all of it
  int frame_end = 0;
  double value = 0.0;       ///< of the code: ms, mm, share of entries that agree, factor, mean departure, margin
  double confidence = 0.0;  ///< [0, 1]
  bool corrected = false;
  bool guessed = false;  ///< likely, below the confidence of a fault: reported, not acted on
  std::string message;
};

Finding FindingOf(const RigFault& fault);

/// Something is wrong for sure and was left as it is: what keypoint views only disagree about is excluded where
/// they do.
bool IsAmbiguous(const RigFault& fault);

/// [{"code", "camera", "frames", "value", "confidence", "corrected"}], one line: what a clip's provenance keeps.
inline constexpr const char* kRigAudit = "rig_audit";
std::string FaultsText(const std::vector<RigFault>& faults);

}  // namespace mocurate
