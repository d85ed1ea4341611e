#include "fitting/clouds/depth_fusion.h"

#include <open3d/geometry/KDTreeSearchParam.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/utility/Logging.h>

#include <algorithm>
#include <exception>
#include <numeric>
#include <string>
#include <tuple>

#include "core/base/sha256.h"
#include "fitting/clouds/depth_image.h"

namespace mocurate {
namespace {

constexpr int kNormalNeighbours = 16;

/// `hash`: of the file when it was ingested, or empty.
Status CheckUnchanged(const std::filesystem::path& file, const std::string& hash) {
  if (hash.empty()) return {};
  const Expected<std::string> now = Sha256OfFile(file);
  if (!now) return Forward(now);
  if (*now == hash) return {};
  return Fail(ErrorCode::kInconsistent, "the file has changed since it was ingested", file.string(), "ingest it again");
}

/// What is not of the person is taken as not measured.
Status ApplyMask(const DepthView& view, int frame, DepthImage& image) {
  if (view.masks.empty()) return {};
  const std::filesystem::path& file = view.masks[frame];
  const Expected<PixelMask> mask = ReadPixelMask(file);
  if (!mask) return Forward(mask);
  if (mask->width != image.width || mask->height != image.height) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(mask->width) + " x " + std::to_string(mask->height) + " pixels, the depth image has " +
                    std::to_string(image.width) + " x " + std::to_string(image.height),
                file.string(), "does the mask belong to this image?");
  }
  if (Status same = CheckUnchanged(file, view.mask_sha256[frame]); !same) return same;
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    if (mask->inside[i] == 0) image.values[i] = 0;
  }
  return {};
}

Status CheckImage(const DepthView& view, int frame, const DepthImage& image) {
  const std::string file = view.files[frame].string();
  if (image.width != view.camera.width || image.height != view.camera.height) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels, camera '" +
                    view.camera.name + "' has " + std::to_string(view.camera.width) + " x " +
                    std::to_string(view.camera.height),
                file, "does the image belong to this camera?");
  }
  return CheckUnchanged(view.files[frame], static_cast<int>(view.sha256.size()) > frame ? view.sha256[frame] : "");
}

/// Sorted copy of a cloud: Open3D's order of voxels comes from a hash map.
FusedCloud Sorted(const open3d::geometry::PointCloud& cloud) {
  std::vector<std::size_t> order(cloud.points_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const Vector3d& p = cloud.points_[a];
    const Vector3d& q = cloud.points_[b];
    return std::tie(p.x(), p.y(), p.z(), a) < std::tie(q.x(), q.y(), q.z(), b);
  });
  FusedCloud sorted{Eigen::Matrix3Xd(3, order.size()), Eigen::Matrix3Xd(3, order.size()), 0};
  for (std::size_t i = 0; i < order.size(); ++i) {
    sorted.points.col(i) = cloud.points_[order[i]];
    sorted.normals.col(i) = cloud.normals_[order[i]];
  }
  return sorted;
}

/// The normals of `cloud` say where the camera is; they orient the estimated ones.
FusedCloud ThinAndClean(const open3d::geometry::PointCloud& cloud, const FusionOptions& options) {
  auto thin = cloud.VoxelDownSample(options.voxel_size);
  const auto neighbours = static_cast<std::size_t>(options.outliers.neighbours);
  if (options.outliers.enabled && thin->points_.size() > neighbours) {
    thin = std::get<0>(thin->RemoveStatisticalOutliers(neighbours, options.outliers.spread_ratio));
  }
  if (thin->points_.size() >= 3) {
    thin->EstimateNormals(open3d::geometry::KDTreeSearchParamKNN(kNormalNeighbours));
  }
  thin->NormalizeNormals();
  return Sorted(*thin);
}

}  // namespace

Expected<Eigen::Matrix3Xd> BackProject(const DepthView& view, int frame) {
  Expected<DepthImage> image = ReadDepthImage(view.files[frame]);
  if (!image) return Forward(image);
  if (Status fits = CheckImage(view, frame, *image); !fits) return Forward(fits);
  if (Status masked = ApplyMask(view, frame, *image); !masked) return Forward(masked);
  const auto is_measured = [](std::uint16_t value) { return value != 0; };
  Eigen::Matrix3Xd points(3, std::count_if(image->values.begin(), image->values.end(), is_measured));
  const RigidTransform world_from_camera = Inverse(view.camera.camera_from_world);
  Eigen::Index next = 0;
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x) {
      const std::uint16_t value = image->values[static_cast<std::size_t>(y) * image->width + x];
      if (!is_measured(value)) continue;
      points.col(next++) = world_from_camera * view.camera.Unproject(Vector2d(x, y), value * view.metres_per_unit);
    }
  }
  return points;
}

Expected<FusedCloud> FuseViews(const std::vector<DepthView>& views, int frame, const FusionOptions& options) {
  open3d::utility::SetVerbosityLevel(open3d::utility::VerbosityLevel::Error);
  open3d::geometry::PointCloud cloud;
  for (const DepthView& view : views) {
    const Expected<Eigen::Matrix3Xd> points = BackProject(view, frame);
    if (!points) return Forward(points);
    const Vector3d centre = view.camera.Centre();
    for (Eigen::Index i = 0; i < points->cols(); ++i) {
      cloud.points_.emplace_back(points->col(i));
      cloud.normals_.emplace_back((centre - points->col(i)).normalized());
    }
  }
  if (cloud.points_.empty()) return FusedCloud{Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xd(3, 0), 0};
  try {
    return ThinAndClean(cloud, options);
  } catch (const std::exception& error) {
    return Fail(ErrorCode::kInconsistent, std::string("the point cloud cannot be thinned: ") + error.what(),
                "frame " + std::to_string(frame), "try a larger voxel_size");
  }
}

}  // namespace mocurate
