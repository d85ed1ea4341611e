#pragma once

#include <string>
#include <vector>

#include "fitting/audit/keypoint_files.h"
#include "fitting/audit/rig_audit.h"
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

}  // namespace mocurate
