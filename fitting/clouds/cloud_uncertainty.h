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
#include "fitting/solver/pose_equations.h"
#include "fitting/terms/pose_state.h"

namespace mocurate {

/// Uncertainty of a frame's pose.
struct CloudUncertainty {
  std::vector<Matrix3d> position;  ///< (J) covariance of joints in the world, m^2
  std::vector<Vector3d> rotation;  ///< (J) variance about the joint's own axes, rad^2
  std::vector<double> prior;       ///< (J) prior variance of the rotation, rad^2
};

/// Of a frame whose unknowns have the covariance (n x n). Needs Update with derivatives.
CloudUncertainty UncertaintyOfCovariance(const PoseColumns& columns, const Skeleton& skeleton, int frame,
                                         const Eigen::MatrixXd& covariance, const PoseState& state,
                                         const PointCloudOptions& options);

/// From the inverse of the Gauss-Newton matrix of the frame's terms, at the minimum in the state; points weighted with
/// `sigma` (CapsuleFitOutcome). Does not include the difference between body and person (BodyErrors). Needs Update.
Expected<CloudUncertainty> UncertaintyOfFrame(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                                              double sigma, PoseState& state, const PointCloudOptions& options);

/// The uncertainty of all frames of a motion, in the layout of Motion.
class UncertainMotion {
 public:
  /// All frames begin without information.
  UncertainMotion(int frames, int joints);
  /// Begins with the uncertainty of `motion`.
  explicit UncertainMotion(const Motion& motion);

  /// `body_error` (J, m): error of the body's joints in every frame, and `body_rotation` (J, rad^2) the rotation of
  /// joint frames that it causes (BodyRotations); both are added to the frame's own. Rotation variances are at most the
  /// prior's.
  void Set(int frame, const CloudUncertainty& uncertainty, const std::vector<double>& body_error,
           const std::vector<Vector3d>& body_rotation);
  /// The same without an error of the body in positions; joints that are not `moving` (J) keep the uncertainty of their
  /// rotation.
  void Replace(int frame, const CloudUncertainty& uncertainty, const std::vector<bool>& moving,
               const std::vector<Vector3d>& body_rotation);
  void Write(Motion& motion) const;

 private:
  void SetPosition(std::size_t at, const Matrix3d& covariance);
  void SetRotation(std::size_t at, const Vector3d& variance, double prior);

  int joints_;
  std::vector<float> position_cov_;
  std::vector<float> rotation_sigma_;
  std::vector<float> rotation_observed_;
};

/// Widens covariances and body errors (J, m) of joints without observations (not `seen`, J): their errors exceed those
/// of pose and body.
void WidenGaps(const std::vector<bool>& seen, CloudUncertainty& uncertainty, std::vector<double>& body_error);

/// Root mean square, 95th percentile and robust standard deviation of distances (m, absolute).
void SetResiduals(std::vector<double> distances, FitResult& result);

/// (J) usual error of this body's joints for the person whose surface was fitted, standard deviation per axis, metres.
/// For size and shape from clouds (FitShape), or, when the skeleton's shape is unknown, for the template scaled to one
/// height. Measured on synthetic people with other body shapes (`bench_fit_clouds`). 0 where the rule is off.
std::vector<double> BodyErrors(const Skeleton& skeleton, double scale, const Rules& rules);

/// Rotations of joint frames that these errors cause in all frames: variances about the axes of the joint's frame ((J),
/// rad^2). `body_error` (J) as above. 0 where the rule is off.
std::vector<Vector3d> BodyRotations(const Skeleton& skeleton, const std::vector<double>& bone_length,
                                    const std::vector<double>& body_error, const Rules& rules);

/// (N) Points that count towards the surface that is seen: one per voxel, or per cell of 3 cm where voxels are smaller.
/// Below that, cameras have fewer pixels than the surface has voxels.
std::vector<bool> CoverageSample(const FusedCloud& cloud, double voxel_size);

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

/// Factor on the body errors of a frame whose points have the distance `residual` (root mean square, metres) from the
/// body: at least 1; 1 where the rule is off.
double BodyErrorFactor(double residual, const Rules& rules);

/// Reports frames whose points lie much farther from the body than in the clip's best frames (`residual`: F, root mean
/// square, metres; 0 without a fit).
void ReportPoorlyExplained(const std::vector<double>& residual, std::vector<Finding>& findings);

}  // namespace mocurate
