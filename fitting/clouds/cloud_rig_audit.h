#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/options.h"

namespace mocurate {

/// Report of a depth view audit.
struct DepthRigReport {
  std::vector<std::string> cameras;
  std::vector<int> frames;  ///< first frame of each sampled group
  /// (cameras, frames) root mean square distance of a view's points to surfaces of other views, before corrections; mm,
  /// 0 without a common surface.
  std::vector<std::vector<double>> residual_mm;
  std::vector<double> loss;            ///< (cameras) mean loss of the comparisons with other views, as given, in [0, 1]
  std::vector<double> loss_after;      ///< after the corrections
  std::vector<double> without_person;  ///< (cameras) share of the moments with a person in another view, but none in
                                       ///< this one
  std::vector<RigFault> faults;
  std::string not_audited;  ///< which tests were impossible, and why; empty: none

  /// A problem was not corrected, or a view contradicts all others and was not excluded.
  bool IsAmbiguous() const;
};

/// Depth views, with the corrections that make them agree.
struct AuditedDepthRig {
  std::vector<DepthView> views;  ///< with poses and files corrected where options allow it, without views that
                                 ///< contradict the others; a frame for which a corrected clock has no image has an
                                 ///< empty file name
  DepthRigReport report;
};

/// Estimates poses, clocks, files and units of depth cameras, by comparing the person's surfaces between views at up to
/// six moments of a clip. Deterministic. Errors of ReadFrame; kInconsistent for wrong units that are only reported, and
/// for different views with one camera pose. Views of unequal length, without files, or with stamps that do not
/// increase stay unchanged.
Expected<AuditedDepthRig> AuditDepthRig(const std::vector<DepthView>& views, const RigAuditOptions& options);

/// The clip with its depth views after AuditDepthRig; writes `report`.
Expected<Clip> WithAuditedRig(const Clip& clip, const RigAuditOptions& options, DepthRigReport& report);

/// The findings of an audit.
std::vector<Finding> FindingsOf(const DepthRigReport& report);

}  // namespace mocurate
