#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/motion/clip.h"
#include "fitting/audit/keypoint_files.h"
#include "fitting/audit/rig_audit.h"
#include "fitting/options.h"
#include "fitting/triangulation/robust_triangulation.h"

namespace mocurate {

/// Statistics of the triangulation of a clip's keypoints.
struct KeypointReport {
  int people = 0;           ///< on which at least two views agree
  double seen_share = 0.0;  ///< of the frames, in which at least two views detect the person
  double median_px = 0.0;   ///< over triangulated points, each the mean over its agreeing views
  double p90_px = 0.0;
  double triangulated = 0.0;  ///< share of frames x keypoints
  double views = 0.0;         ///< that agree on a point, mean
  bool suspect = false;       ///< a finding gives the reason
  std::vector<std::string> keypoint_names;
  std::vector<double> keypoint_share;  ///< (K) of the frames, triangulated
  std::vector<std::string> camera_names;
  std::vector<CameraAgreement> cameras;
  Matrix3d place_covariance = Matrix3d::Zero();  ///< see AuditedRig
  FileFindings files;                            ///< of the audit
  RigEstimate rig;                               ///< of the audit
  std::vector<RigFault> faults;                  ///< of the rig, its calibration or its files
  std::vector<std::string> given_cameras;        ///< as the evidence lists them
  std::vector<std::vector<double>> residual_px;  ///< (given cameras, spans of the take), before corrections
};

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
