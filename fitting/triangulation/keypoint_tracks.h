#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/motion/clip.h"
#include "fitting/options.h"
#include "fitting/triangulation/keypoint_report.h"

namespace mocurate {

/// A person's triangulated keypoints, with the skeleton's names (DetectorNames). Confidence is relative precision: 1
/// for the median of the take.
struct KeypointTracks {
  JointTracks tracks;
  std::vector<Matrix3d> precision;  ///< (F*K) of the tracks, see SkeletonTracks
  KeypointReport report;
  std::vector<Finding> findings;  ///< clip id left empty
};

/// Person `evidence.subject` of the clip's keypoint views: associated across views and time, ordered by presence,
/// triangulated. `skeleton` gives bones and their lengths. First the rig is audited (CorrectFileAssignment, AuditRig,
/// FindKeypointOrder, FindUnit), and corrected where options allow it: each fault is a finding. Further findings: other
/// people, excluded detections, a camera that disagrees, keypoints never triangulated, views too close together.
/// Errors, each with its numbers: kInconsistent for shapes that disagree, fewer than two cameras, a missing person; for
/// views without agreement, with the geometry of their rays (all from one direction, meeting behind the cameras,
/// missing each other); for an implausible size (the calibration's unit) or implausible proportions (the order of the
/// keypoints). With an audited rig (`options.rig`) its corrections are used, and the audit corrects nothing in
/// addition: what it would correct is a finding "rig_contradicted". Errors of ReadRigFile and WithRig. `takes`: the
/// evidence is of several takes in sequence (AuditRig).
Expected<KeypointTracks> TriangulateKeypoints(const Evidence& evidence, const Skeleton& skeleton,
                                              const KeypointFitOptions& options, const TakeStarts& takes = {});

}  // namespace mocurate
