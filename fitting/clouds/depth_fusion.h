#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/base/error.h"
#include "core/motion/clip.h"
#include "fitting/options.h"

namespace mocurate {

/// Points from several cameras at one time. World, metres; columns are points, sorted by x, then y, then z.
struct FusedCloud {
  Eigen::Matrix3Xd points;
  Eigen::Matrix3Xd normals;  ///< unit, towards the observing cameras
  int excluded = 0;          ///< points that are not of the person
  double spacing = 0.03;     ///< m; edge of the surface that a point stands for (SpacingOf)

  int size() const { return static_cast<int>(points.cols()); }
};

inline constexpr int kFewestPoints = 100;  ///< points; fewest of a cloud to which a body is fitted

/// `hash`: of the file at ingestion, or empty. Error kInconsistent if it differs.
Status CheckUnchanged(const std::filesystem::path& file, const std::string& hash);

/// m; edge of the voxels that areas of visible surface were measured with (numerical).
inline constexpr double kCoverageCell = 0.03;

/// (N) Points that count towards the surface that is seen: one per voxel, or per cell of 3 cm where voxels are smaller.
/// Below that, cameras have fewer pixels than the surface has voxels.
std::vector<bool> CoverageSample(const FusedCloud& cloud, double voxel_size);

/// Voxels that a surface occupies grow with the inverse square of their edge, until the camera has fewer pixels: the
/// edge (m, at least `voxel_size`) at which a surface has as many voxels as the cloud has points.
double SpacingOf(const FusedCloud& cloud, double voxel_size);

/// Some of a cloud's points, of its spacing.
FusedCloud ChosenPoints(const FusedCloud& cloud, const std::vector<int>& points);

/// Every n-th point, about `count` in total.
FusedCloud CoarseCloud(const FusedCloud& cloud, int count);

/// The images of a frame, one per view: decoded, without pixels outside the masks; empty for a view whose file has no
/// name. Errors of ReadDepthImage; kInconsistent for an image with another size than its camera, or changed since
/// ingestion (where a hash is given).
Expected<std::vector<DepthImage>> ReadFrame(const std::vector<DepthView>& views, int frame);

/// The surface at a measured pixel, in the camera's frame.
struct PixelPlane {
  Vector3d point;   ///< metres, on the pixel's ray
  Vector3d normal;  ///< unit, towards the camera
};

/// The plane through a pixel and its neighbours; empty when few of those lie near it. The pixel must be in the image
/// and measured.
std::optional<PixelPlane> PlaneAtPixel(const DepthView& view, const DepthImage& image, int x, int y);

/// Back-projects images of all views (from ReadFrame), keeps one point per voxel. A
/// pixel with few near neighbours (flying pixels) is dropped. Normals are of the planes through the neighbours.
/// Deterministic, in a fixed order. May be empty. Error kInconsistent for voxels too small to be indexed.
Expected<FusedCloud> FuseImages(const std::vector<DepthView>& views, const std::vector<DepthImage>& images,
                                double voxel_size);

/// Points in the world, metres, thinned like FuseImages. Without `normals` they are estimated from planes
/// through neighbouring points, up rather than down (FaceOutwards orients them). Error of FuseImages.
Expected<FusedCloud> FusePoints(std::vector<Vector3d> points, std::vector<Vector3d> normals, double voxel_size);

/// Reads a frame and fuses it with FuseImages.
Expected<FusedCloud> FuseViews(const std::vector<DepthView>& views, int frame, double voxel_size);

/// Reads a PNG of one 16-bit channel. Errors: kNotFound, kUnreadable, kMalformed for a damaged image or other pixels.
Expected<DepthImage> ReadDepthImage(const std::filesystem::path& path);

/// Reads a mask, an 8-bit PNG or JPEG: inside where the first channel is at least 128 (JPEG blurs edges). Errors of
/// ReadDepthImage.
Expected<PixelMask> ReadPixelMask(const std::filesystem::path& path);

}  // namespace mocurate
