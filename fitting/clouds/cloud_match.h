#pragma once

#include <vector>

#include "fitting/clouds/depth_fusion.h"
#include "fitting/terms/surface.h"

namespace mocurate {

/// Factor on the usual deviations from the template when the body shape is unknown (a given height, a tracker's own
/// points, other skeletons), so that the template's is used. Source: bench_fit_clouds
inline constexpr double kUnknownShape = 3.0;

/// m; mean movement of the joints at convergence of a fit, well below the error of the body (numerical).
inline constexpr double kSettled = 1e-3;

/// Nearest capsule of every point within `max_distance`, in the order of the points. A capsule whose surface normal
/// differs from the point's counts as farther. Needs PoseState::Update of the frame.
std::vector<CloudMatch> MatchPoints(const CapsuleBody& body, const PoseState& state, int frame, const FusedCloud& cloud,
                                    double max_distance);

/// Robust standard deviation of distances about zero, at least 3 mm.
double RobustSigma(std::vector<double> distances);
double RobustSigma(const std::vector<CloudMatch>& matches);

/// Estimates radii: for each capsule the median distance of its points to its axis, left and right together. Shrinks to
/// the previous radius when points are few. Uses frames [begin, end) of the state.
void CalibrateRadii(const std::vector<FusedCloud>& clouds, const PoseState& state, int begin, int end,
                    double max_distance, CapsuleBody& body);

/// Fits capsule ends (in their joints' frames) and radii to the points of some frames with known poses. Linear least
/// squares per capsule, left and right together, with a prior from the usual variation between people and template.
/// `pose_variance` (J, m^2 per axis) is the uncertainty of the poses, common to all frames: an offset of that size is
/// attributed to the pose. Returns the share of the prior shape variance that remains, mean over capsules. Needs Update
/// of these frames.
double FitCapsuleOffsets(const std::vector<FusedCloud>& clouds, const PoseState& state, const std::vector<int>& frames,
                         double max_distance, const std::vector<double>& pose_variance, CapsuleBody& body);

}  // namespace mocurate
