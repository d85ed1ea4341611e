#pragma once

#include <vector>

#include "core/motion/motion.h"
#include "fitting/solver/track_problem.h"
#include "fitting/terms/pose_gaussian.h"

namespace mocurate {

/// Uncertainty of a fit, and the share determined by evidence.
struct PoseUncertainty {
  std::vector<float> position_cov;       ///< (F*J*6) of joints in the world, xx xy xz yy yz zz, m^2
  std::vector<float> rotation_sigma;     ///< (F*J*3) rad, about the joint's own axes
  std::vector<float> rotation_observed;  ///< (F*J*3) 1 - posterior / prior variance, in [0, 1]
  PoseCovariances poses;                 ///< only where the options want them (JointTrackOptions::poses)
  double variance_factor = 1.0;          ///< a-posteriori variance of the whitened residuals; 1: noise as assumed
};

/// Uncertainty of a solved fit: diagonal blocks of the inverse of the Gauss-Newton matrix at the solution (selected
/// inversion, memory bounded by a window). The part from evidence is scaled by the a-posteriori variance and
/// calibrated. `whole` is the whole clip. A rotation vector's error is given in the joint's frame, J_r dw. The prior
/// variance of a rotation is that of rest pose and random walk without evidence (TrackProblem::RestInformation), at
/// most the typical rotation; for the root that of a uniform angle, pi^2 / 3. No standard deviation is larger.
/// Directions without evidence, such as the twist of a straight limb, keep their prior variance: observed 0. Bodies
/// that are not the person's add what the pose does then (BodyResponse). Persistent residuals add theirs
/// (PersistentResidualCovariance). After 0.6 s without observation, standard deviations grow with the gap's length
/// (FindGapInflation). The a-posteriori variance is at least `least_factor`, for noise that residuals do not show.
/// Error kInconsistent if the matrix cannot be factored.
Expected<PoseUncertainty> UncertaintyOfTracks(const TrackProblem& whole, double least_factor = 0.0);

}  // namespace mocurate
