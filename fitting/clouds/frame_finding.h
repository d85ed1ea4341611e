#pragma once

#include <vector>

#include "core/base/finding.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/clouds/depth_fusion.h"

namespace mocurate {

/// How far joints are off, beside pose and body, where points show little of the person: standard deviation per axis,
/// metres. Of one side: by the length of the mean of the points' normals, which is 0 all around, 0.3 to 0.6 of three
/// views, 0.7 to 0.78 of one (pi/4 of a limb whose pixels count alike). Above that the surface is seen as flat, far
/// away: how it curves, which tells where a limb's axis lies and which way a trunk faces, is lost in the noise. Of a
/// part of the person: by the area of the points, of which one a `voxel_size` (m) wide is left; arms are taken for
/// legs. Of Kinect-like pixels and voxels of a few centimetres, and bodies `scale` times the rest skeleton.
double LowCoverageSigma(const FusedCloud& cloud, double voxel_size, double scale);

/// That is so much, in metres, that a pose is a guess, and nothing of it counts as observed.
inline constexpr double kUnobservedError = 0.03;

/// Finding codes: frames that are mostly unobserved, and frames whose points lie off the body.
inline constexpr const char* kLowCoverage = "low_coverage";
inline constexpr const char* kPoorlyExplained = "high_residual";

/// IsConclusive of frames that are guesses (`error`: F, metres; 0 where nothing was fitted).
void ReportLowCoverage(const std::vector<double>& error, std::vector<Finding>& findings);

/// Of the distances of matched points, metres; 0 of none.
double ResidualOf(const std::vector<CloudMatch>& matches);

/// How many times the usual errors of a body those are of a frame whose points lie `residual` (root mean square,
/// metres) off it: at least 1.
double BodyErrorFactor(double residual);

/// IsConclusive of frames whose points lie much farther off the body than the clip's best (`residual`: F, root mean
/// square, metres; 0 where nothing was fitted).
void ReportPoorlyExplained(const std::vector<double>& residual, std::vector<Finding>& findings);

}  // namespace mocurate
