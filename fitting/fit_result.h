#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/motion/motion.h"
#include "fitting/clouds/cloud_rig_audit.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/terms/pose_gaussian.h"
#include "fitting/triangulation/keypoint_tracks.h"

namespace mocurate {

/// Code of the findings of samples that jump away and back, one per joint; value: their count.
inline constexpr const char* kOutliersRejected = "outliers_rejected";
/// Code of the findings of observed samples that contradict the fitted body, one per joint; value: their count. The
/// joint's state in these frames is kInterpolated or kInferred; nothing else changes.
inline constexpr const char* kSamplesContradicted = "samples_contradicted";

/// Code of the finding of a fit to depth that another pose explains about as well; value: the other one's chance.
inline constexpr const char* kAmbiguousPose = "ambiguous_pose";

/// Code of the finding of a fit whose uncertainty is not determined somewhere: it states none.
inline constexpr const char* kNoUncertainty = "uncertainty_undetermined";
Finding NoUncertainty(const Error& error);

/// A fitted motion and its residuals. Lengths in metres.
struct FitResult {
  Motion motion;              ///< with rotations, bone lengths, joints and states
  double residual_rms = 0.0;  ///< evidence to body, observed samples that are not rejected, by their precision if known
  double residual_p95 = 0.0;
  double rejected_share = 0.0;   ///< of the observed samples: outliers
  double residual_median = 0.0;  ///< of joints (with points: before the fit to points); 0 of a fit to points alone
  double noise_sigma = 0.0;      ///< per axis, as estimated from the evidence
  double variance_factor = 1.0;  ///< a-posteriori variance over the assumed one; included in the uncertainty
  int iterations = 0;            ///< all windows together
  bool converged = false;        ///< every window stopped at its tolerance
  std::string termination;       ///< "converged", "iteration limit" or the solver's message
  double initial_cost = 0.0;     ///< whitened, 1/2 sum of rho(|r|^2)
  double final_cost = 0.0;
  PoseCovariances poses;                       ///< of a fit of tracks to which depth is added; else empty
  std::string capsule_radii;                   ///< RadiiText of the body that was fitted; empty without one
  std::string track_repairs;                   ///< RepairsText of corrections of the tracks; empty without any
  std::string rig_audit;                       ///< FaultsText of the cameras; empty without faults
  std::optional<KeypointReport> keypoints;     ///< of a fit to 2-D keypoints
  std::optional<SkeletonTracks> triangulated;  ///< its joints before the fit
  std::optional<DepthRigReport> depth_rig;     ///< of a fit to depth views
  std::optional<double> surface_weight;        ///< weight of depth points against joints; of a fit to both
  std::vector<Vector3d> other_pose;            ///< (J) joints in the first frame, of kAmbiguousPose; else empty
  std::vector<Finding> findings;               ///< clip id left empty
};

/// The error with the clip's id before its place.
tl::unexpected<Error> InClip(Error error, const Clip& clip);

/// Code of the findings of frames in which no part of the person was observed.
inline constexpr const char* kFramesWithoutEvidence = "frames_without_evidence";

/// One finding per run of frames that are `without` (F): `what`, the number of frames and the replacement.
void ReportFramesWithout(const std::vector<bool>& without, const std::string& what, std::vector<Finding>& findings);

}  // namespace mocurate
