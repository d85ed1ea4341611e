#pragma once

#include <vector>

#include "core/motion/motion.h"
#include "fitting/clouds/cloud_uncertainty.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/fit_result.h"

namespace mocurate {

/// The uncertainty of all frames of a motion, as Motion stores it.
class UncertainMotion {
 public:
  /// Of frames that are not set nothing is known.
  UncertainMotion(int frames, int joints);
  /// Begins with the uncertainty of another motion.
  explicit UncertainMotion(const Motion& motion);

  /// `body_error` (J, m): how far each joint of the body is from the person's, which every frame has beside its own,
  /// and `body_turn` (J, rad^2) how far that turns its frame (BodyTurns). No rotation is less known than beforehand.
  void Set(int frame, const CloudUncertainty& uncertainty, const std::vector<double>& body_error,
           const std::vector<Vector3d>& body_turn);
  /// Takes a frame's uncertainty over; of joints that are not `turned` (J) rotations stay as known as they were.
  void Replace(int frame, const CloudUncertainty& uncertainty, const std::vector<bool>& turned,
               const std::vector<Vector3d>& body_turn);
  void Write(Motion& motion) const;

 private:
  void SetPosition(std::size_t at, const Matrix3d& covariance);
  void SetRotation(std::size_t at, const Vector3d& variance, const Vector3d& observed);

  int joints_;
  std::vector<float> position_cov_;
  std::vector<float> rotation_sigma_;
  std::vector<float> rotation_observed_;
};

/// Joints of which no view shows anything are farther off than pose and body tell: widens their covariances and what
/// their body is off (J, m) where they are not `seen` (J).
void WidenUnseen(const std::vector<bool>& seen, CloudUncertainty& uncertainty, std::vector<double>& body_error);

/// How far joints are off, beside pose and body, where points show little of the person: standard deviation per axis,
/// metres. Of one side: by the length of the mean of the points' normals, which is 0 all around, 0.3 to 0.6 of three
/// views, 0.7 to 0.78 of one (pi/4 of a limb whose pixels count alike). Above that the surface is seen as flat, far
/// away: how it curves, which tells where a limb's axis lies and which way a trunk faces, is lost in the noise. Of a
/// part of the person: by the area of the points, of which one a `voxel_size` (m) wide is left; arms are taken for
/// legs. Of Kinect-like pixels and voxels of a few centimetres, and bodies `scale` times the rest skeleton.
double ErrorOfLittleSeen(const FusedCloud& cloud, double voxel_size, double scale);

/// That is so much, in metres, that a pose is a guess, and nothing of it counts as observed.
inline constexpr double kGuessedError = 0.03;

/// Codes of what is told of frames that are guesses, and of frames whose points lie off the body.
inline constexpr const char* kLittleSeen = "little_of_person_seen";
inline constexpr const char* kPoorlyExplained = "poorly_explained";

/// Tells of frames that are guesses (`error`: F, metres; 0 where nothing was fitted).
void ReportLittleSeen(const std::vector<double>& error, std::vector<Finding>& findings);

/// How many times the usual errors of a body those are of a frame whose points lie `residual` (root mean square,
/// metres) off it: at least 1.
double BodyErrorFactor(double residual);

/// Tells of frames whose points lie much farther off the body than the clip's best (`residual`: F, root mean square,
/// metres; 0 where nothing was fitted).
void ReportPoorlyExplained(const std::vector<double>& residual, std::vector<Finding>& findings);

/// Root mean square, 95th percentile and robust spread of distances (m, absolute).
void SetResiduals(std::vector<double> distances, FitResult& result);

}  // namespace mocurate
