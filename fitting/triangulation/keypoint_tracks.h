#pragma once

#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/motion/clip.h"
#include "fitting/options.h"
#include "fitting/triangulation/keypoint_report.h"

namespace mocurate {

/// A person's triangulated keypoints, named as a skeleton means them (DetectorNames). Confidence is relative precision:
/// 1 for the median of the take.
struct KeypointTracks {
  JointTracks tracks;
  std::vector<Matrix3d> precision;  ///< (F*K) of the tracks, see SkeletonTracks
  KeypointReport report;
  std::vector<Finding> findings;  ///< clip id left empty
};

/// Person `evidence.subject` of the clip's keypoint views: associated across views and time, ordered by presence,
/// triangulated. `skeleton` says which keypoints are ends of bones, and how long bones are. The rig is audited first
/// (MendFiles, AuditRig, FindKeypointOrder, FindUnit), and corrected where options say so: each fault is a
/// finding. Further findings: other people, entries left out, a camera that disagrees, keypoints never found, views too
/// close together. Errors, each with its numbers: kInconsistent for shapes that disagree, fewer than two cameras, a
/// person that is not there; for views that agree on nobody, with what their rays do (all from one direction, meeting
/// behind the cameras, missing each other); for a body of no person's size (the calibration's unit) or of no person's
/// proportions (the order of the keypoints).
Expected<KeypointTracks> TriangulateKeypoints(const Evidence& evidence, const Skeleton& skeleton,
                                              const KeypointFitOptions& options);

}  // namespace mocurate
