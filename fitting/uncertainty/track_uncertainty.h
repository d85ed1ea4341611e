#pragma once

#include <vector>

#include "core/motion/motion.h"
#include "fitting/solver/track_window.h"

namespace mocurate {

/// Share of the variance that the information states: the random walk allows for more than people do. Calibrated on
/// synthetic takes (`bench_studio_fits`, `bench_keypoints`), where errors then lie within one and two sigma as often as
/// they should.
inline constexpr double kUncertaintyCalibration = 0.72;

/// How uncertain a fit is, and what of that the evidence decided.
struct PoseUncertainty {
  std::vector<float> position_cov;       ///< (F*J*6) of joints in the world, xx xy xz yy yz zz, m^2
  std::vector<float> rotation_sigma;     ///< (F*J*3) rad, about the joint's own axes
  std::vector<float> rotation_observed;  ///< (F*J*3) 1 - posterior / prior variance, in [0, 1]
  double variance_factor = 1.0;          ///< a-posteriori variance of the whitened residuals; 1: noise as assumed
};

/// Uncertainty of a solved fit: diagonal blocks of the inverse of the Gauss-Newton matrix at the solution (selected
/// inversion, memory bounded by a window); what the evidence decides is scaled by the a-posteriori variance and
/// calibrated. `window` is the whole clip. Of a rotation vector's error the part in the joint's frame, J_r dw. The
/// prior variance of a rotation is that of the rest pose and the random walk without evidence (RestInformationOfWalks),
/// and never more than people turn the joint, the root's that of an angle of which nothing is known, pi^2 / 3; no
/// standard deviation is larger either. What the evidence does not
/// touch, such as the twist of a straight limb, keeps its prior variance: observed 0. Bones that
/// the tracks show are taken as exact; the others add what bodies differ in (CovarianceOfBody), and samples that lie to
/// one side of the fit for long how far they do (CovarianceOfLasting). Of what is not seen for longer than 0.6 s
/// standard deviations grow with the gap's length (GrowthOfUnseen). The a-posteriori variance is `least_factor` at
/// least: of noise that no residual shows. Error kInconsistent if the matrix cannot be factored.
Expected<PoseUncertainty> UncertaintyOfTracks(const TrackWindow& window, double least_factor = 0.0);

}  // namespace mocurate
