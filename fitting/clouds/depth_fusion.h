#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/options.h"

namespace mocurate {

/// What several cameras see at one time. World, metres; columns are points, sorted by x, then y, then z.
struct FusedCloud {
  Eigen::Matrix3Xd points;
  Eigen::Matrix3Xd normals;  ///< unit, towards the cameras that saw the point
  int left_out = 0;          ///< points that were seen but are not of the person

  int size() const { return static_cast<int>(points.cols()); }
};

/// Thinning and cleaning of a fused cloud.
struct FusionOptions {
  double voxel_size = 0.015;  ///< m
  CloudOutlierOptions outliers;
};

/// Every measured pixel of one view in the world, in the order of the pixels. Errors of ReadDepthImage; kInconsistent
/// for an image of another size than its camera, or another content than when it was ingested (where a hash is given).
Expected<Eigen::Matrix3Xd> BackProject(const DepthView& view, int frame);

/// Back-projects a frame of all views, keeps one point per voxel, drops statistical outliers and estimates normals.
/// Same input, same points in the same order. Errors of BackProject. May be empty.
Expected<FusedCloud> FuseViews(const std::vector<DepthView>& views, int frame, const FusionOptions& options);

}  // namespace mocurate
