#pragma once

#include <vector>

#include "core/base/finding.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/options.h"

namespace mocurate {

/// (N) Points that count towards the surface that is seen: one per voxel, or per cell of 3 cm where voxels are smaller.
/// Below that, cameras have fewer pixels than the surface has voxels.
std::vector<bool> CoverageSample(const FusedCloud& cloud, double voxel_size);

/// Surface that such a point stands for, m^2.
double CoverageOfPoint(double voxel_size);

/// Additional joint error when points cover little of the person: standard deviation per axis, metres. One visible
/// side: from the length of the mean of the points' normals. It is 0 for points all around, 0.3 to 0.6 for three views,
/// 0.7 to 0.78 for one. A limb with pixels of equal weight gives pi/4. Above that the surface looks flat, as from afar:
/// its curvature, which determines limb axes and trunk orientation, is lost in noise. One visible part: from the area
/// of the points (CoverageSample, voxels of `voxel_size` metres), because arms are fitted to legs. For Kinect-like
/// pixels, voxels of a few centimetres, and bodies `scale` times the rest skeleton.
double LowCoverageSigma(const FusedCloud& cloud, double voxel_size, double scale);
/// The same; 0 where the rule is off.
inline double LowCoverageSigma(const FusedCloud& cloud, const PointCloudOptions& options, double scale) {
  return options.rules.on(FittingRule::kLowCoverage) ? LowCoverageSigma(cloud, options.voxel_size, scale) : 0.0;
}

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
/// body: at least 1.
double BodyErrorFactor(double residual);
/// The same; 1 where the rule is off.
inline double BodyErrorFactor(double residual, const Rules& rules) {
  return rules.on(FittingRule::kBodyErrorFactor) ? BodyErrorFactor(residual) : 1.0;
}

/// Reports frames whose points lie much farther from the body than in the clip's best frames (`residual`: F, root mean
/// square, metres; 0 without a fit).
void ReportPoorlyExplained(const std::vector<double>& residual, std::vector<Finding>& findings);

}  // namespace mocurate
