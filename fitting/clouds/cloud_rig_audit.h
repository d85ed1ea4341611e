#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/options.h"

namespace mocurate {

/// What an audit of depth views says of them.
struct DepthRigReport {
  std::vector<std::string> cameras;
  std::vector<int> frames;  ///< that were looked at, each with the next
  /// (cameras, frames) root mean square distance of a view's points to the surfaces that others see there, before
  /// anything is corrected; mm, 0 where no other view sees the same surface.
  std::vector<std::vector<double>> residual_mm;
  std::vector<double> loss;            ///< (cameras) mean loss of the comparisons with others, as given, in [0, 1]
  std::vector<double> loss_after;      ///< and as corrected
  std::vector<double> without_person;  ///< (cameras) share of the moments in which another camera observes the person
  std::vector<RigFault> faults;
  std::string not_audited;  ///< what was not looked for, and why; empty: all was, or was not to be

  /// Something is wrong and was left as it is, or a view contradicts every other one and was not excluded.
  bool IsAmbiguous() const;
};

/// Depth views, and how they had to be taken to agree with each other.
struct AuditedDepthRig {
  std::vector<DepthView> views;  ///< with poses and files corrected where options say so, without those that contradict
                                 ///< the others; a frame for which a corrected clock has no image has an empty file
                                 ///< name
  DepthRigReport report;
};

/// Places, clocks, files and units of depth cameras, from what views of the person say of each other at up to six
/// moments of a clip. Same input, same result. Errors of ReadFrame; kInconsistent for units that are reported and not
/// to be corrected, and for cameras in one place that see different things. Views of unequal length, without files, or
/// with stamps that do not increase are taken as they are.
Expected<AuditedDepthRig> AuditDepthRig(const std::vector<DepthView>& views, const RigAuditOptions& options);

/// The clip with its depth views as AuditDepthRig leaves them; the report goes to `report`.
Expected<Clip> WithAuditedRig(const Clip& clip, const RigAuditOptions& options, DepthRigReport& report);

/// What an audit found, for people.
std::vector<Finding> FindingsOf(const DepthRigReport& report);

}  // namespace mocurate
