#pragma once

#include <vector>

#include "core/base/finding.h"
#include "core/body/capsule_body.h"
#include "core/motion/motion.h"
#include "fitting/clouds/capsule_fit.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/fit_result.h"
#include "fitting/options.h"
#include "fitting/rules.h"
#include "fitting/terms/pose_state.h"
#include "fitting/uncertainty/pose_posterior.h"

namespace mocurate {

/// How far the body of a depth fit may be from the person's, for bodies `scale` times the rest skeleton: bones by the
/// share `bones` of what they vary between people (SpreadOfBone), capsules by kCapsuleSigma. Larger for a template of
/// unknown shape. Without bones and capsules where the rule is off.
BodyDeviations DeviationsInClouds(const Skeleton& skeleton, double scale, double bones, const Rules& rules);

/// (J) Variances of rotations of a depth fit without points, rad^2.
std::vector<Vector3d> PriorInClouds(const Skeleton& skeleton, const PointCloudOptions& options);

/// From the inverse of the Gauss-Newton matrix of the frame's terms, at the minimum in the state; points weighted with
/// `sigma` (CapsuleFitOutcome). Includes what a body that is not the person's does (DeviationsInClouds) where
/// `of_body`. Needs Update.
Expected<PosePosterior> UncertaintyOfFrame(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                                           double sigma, const BodyDeviations& deviations, PoseState& state,
                                           const PointCloudOptions& options);

/// The uncertainty of all frames of a motion, in the layout of Motion.
class UncertainMotion {
 public:
  /// All frames begin without evidence: variances of rotations `prior` (J), rad^2.
  UncertainMotion(int frames, const std::vector<Vector3d>& prior);
  /// Begins with the uncertainty of `motion`.
  explicit UncertainMotion(const Motion& motion);

  /// `more`: m, standard deviation per axis that is added to every joint.
  void Set(int frame, const PosePosterior& posterior, double more = 0.0);
  /// The same; joints that are not `moving` (J) keep the uncertainty of their rotation.
  void Replace(int frame, const PosePosterior& posterior, const std::vector<bool>& moving);
  void Write(Motion& motion) const;

 private:
  void SetPosition(std::size_t at, const Matrix3d& covariance);
  void SetRotation(std::size_t at, const Vector3d& variance, const Vector3d& prior);

  int joints_;
  std::vector<float> position_cov_;
  std::vector<float> rotation_sigma_;
  std::vector<float> rotation_observed_;
};

/// Root mean square, 95th percentile and robust standard deviation of distances (m, absolute).
void SetResiduals(std::vector<double> distances, FitResult& result);

/// Surface that such a point stands for, m^2.
double CoverageOfPoint(double voxel_size);

/// Additional joint error when points cover little of the person: standard deviation per axis, metres. One visible
/// side: from the length of the mean of the points' normals. It is 0 for points all around, 0.3 to 0.6 for three views,
/// 0.7 to 0.78 for one. A limb with pixels of equal weight gives pi/4. Above that the surface looks flat, as from afar:
/// its curvature, which determines limb axes and trunk orientation, is lost in noise. One visible part: from the area
/// of the points (CoverageSample), because arms are fitted to legs. For Kinect-like
/// pixels, voxels of a few centimetres, and bodies `scale` times the rest skeleton. 0 where the rule is off.
double LowCoverageSigma(const FusedCloud& cloud, const PointCloudOptions& options, double scale);

/// m; error from which no joint of the frame counts as observed.
inline constexpr double kUnobservedError = 0.03;

/// Codes of findings on frames with low coverage, and on frames with points far from the body.
inline constexpr const char* kLowCoverage = "low_coverage";
inline constexpr const char* kPoorlyExplained = "high_residual";

/// Reports frames with low coverage (`error`: F, metres; 0 without a fit).
void ReportLowCoverage(const std::vector<double>& error, std::vector<Finding>& findings);

/// Root mean square of the distances of matched points, metres; 0 without matches.
double ResidualOf(const std::vector<CloudMatch>& matches);

/// Factor on the deviations of the body in a frame whose points have the distance `residual` (root mean square, metres)
/// from the body: at least 1; 1 where the rule is off.
double BodyErrorFactor(double residual, const Rules& rules);

/// Reports frames whose points lie much farther from the body than in the clip's best frames (`residual`: F, root mean
/// square, metres; 0 without a fit).
void ReportPoorlyExplained(const std::vector<double>& residual, std::vector<Finding>& findings);

}  // namespace mocurate
