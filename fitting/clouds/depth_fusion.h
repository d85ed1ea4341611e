#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/depth_image.h"
#include "core/motion/clip.h"
#include "fitting/options.h"

namespace mocurate {

/// What several cameras see at one time. World, metres; columns are points, sorted by x, then y, then z.
struct FusedCloud {
  Eigen::Matrix3Xd points;
  Eigen::Matrix3Xd normals;  ///< unit, towards the cameras that saw the point
  int excluded = 0;          ///< points that were seen but are not of the person

  int size() const { return static_cast<int>(points.cols()); }
};

/// `hash`: of the file when it was ingested, or empty. Error kInconsistent if it has another one now.
Status CheckUnchanged(const std::filesystem::path& file, const std::string& hash);

/// Every n-th point, so that about `count` are left.
FusedCloud CoarseCloud(const FusedCloud& cloud, int count);

/// Thinning and cleaning of a fused cloud.
struct FusionOptions {
  double voxel_size = 0.03;  ///< m
  CloudOutlierOptions outliers;
};

/// The images of a frame, one per view: decoded, and without what lies outside the masks; a view whose file has no name
/// measured nothing. Errors of ReadDepthImage;
/// kInconsistent for an image of another size than its camera, or another content than when it was ingested (where a
/// hash is given).
Expected<std::vector<DepthImage>> ReadFrame(const std::vector<DepthView>& views, int frame);

/// Every measured pixel of one view in the world, in the order of the pixels. Errors of ReadFrame.
Expected<Eigen::Matrix3Xd> BackProject(const DepthView& view, int frame);

/// The surface about a measured pixel, in the camera's frame.
struct PixelPlane {
  Vector3d point;   ///< metres, on the pixel's ray
  Vector3d normal;  ///< unit, towards the camera
};

/// The plane through a pixel of an image and its neighbours; empty where few of those lie near it. The pixel must be in
/// the image and measured.
std::optional<PixelPlane> PlaneAtPixel(const DepthView& view, const DepthImage& image, int x, int y);

/// Back-projects images of all views (as ReadFrame gives them), keeps one point per voxel and drops statistical
/// outliers. A pixel that few of its neighbours lie near (flying pixels, stray ones) is none; normals are those of the
/// planes through the neighbours. Same input, same points in the same order. May be empty. Error kInconsistent for
/// voxels too small to be counted.
Expected<FusedCloud> FuseImages(const std::vector<DepthView>& views, const std::vector<DepthImage>& images,
                                const FusionOptions& options);

/// Points in the world, metres, thinned and cleaned as FuseImages does. Without `normals` they are those of planes
/// through neighbouring points, up rather than down (FaceOutwards turns them). Error as FuseImages.
Expected<FusedCloud> FusePoints(std::vector<Vector3d> points, std::vector<Vector3d> normals,
                                const FusionOptions& options);

/// FuseImages of a frame that is read first.
Expected<FusedCloud> FuseViews(const std::vector<DepthView>& views, int frame, const FusionOptions& options);

}  // namespace mocurate
