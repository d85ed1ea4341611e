#include "fitting/clouds/depth_fusion.h"

#include <open3d/geometry/PointCloud.h>
#include <open3d/utility/Logging.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <exception>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "core/base/sha256.h"
#include "fitting/clouds/depth_image.h"

namespace mocurate {
namespace {

constexpr int kHalfWindow = 2;           ///< pixels around one that its normal is read from
constexpr double kFewestOfWindow = 0.6;  ///< share of the window; a pixel with fewer is a stray one
constexpr double kSurface = 0.04;        ///< m in depth; a neighbour farther off is of another surface
constexpr double kPixelsPerVoxel = 2.0;  ///< along each axis, looked at

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

FusedCloud ThinAndClean(const open3d::geometry::PointCloud& cloud, const FusionOptions& options) {
  auto thin = cloud.VoxelDownSample(options.voxel_size);
  const auto neighbours = static_cast<std::size_t>(options.outliers.neighbours);
  if (options.outliers.enabled && thin->points_.size() > neighbours) {
    thin = std::get<0>(thin->RemoveStatisticalOutliers(neighbours, options.outliers.spread_ratio));
  }
  thin->NormalizeNormals();
  return Sorted(*thin);
}

/// The surface about a pixel: on a plane, inverse depth is linear in the pixel, 1/z = at + across du + down dv.
struct LocalPlane {
  double at = 0.0;
  double across = 0.0;
  double down = 0.0;
};

/// Empty where too few neighbours are of the pixel's surface.
std::optional<LocalPlane> PlaneAt(const DepthImage& image, double metres_per_unit, int x, int y) {
  const auto value = [&](int px, int py) { return image.values[static_cast<std::size_t>(py) * image.width + px]; };
  const double depth = value(x, y) * metres_per_unit;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  int count = 0;
  for (int dy = -kHalfWindow; dy <= kHalfWindow; ++dy) {
    for (int dx = -kHalfWindow; dx <= kHalfWindow; ++dx) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= image.width || y + dy >= image.height) continue;
      const double other = value(x + dx, y + dy) * metres_per_unit;
      if (other == 0.0 || std::abs(other - depth) > kSurface) continue;
      const Vector3d row(1.0, dx, dy);
      normal += row * row.transpose();
      right += row / other;
      ++count;
    }
  }
  constexpr int kWindow = (2 * kHalfWindow + 1) * (2 * kHalfWindow + 1);
  if (count < kFewestOfWindow * kWindow) return std::nullopt;
  const Vector3d plane = normal.llt().solve(right);
  return LocalPlane{plane[0], plane[1], plane[2]};
}

/// Every so-many-th pixel is enough for a cloud of one point per voxel.
int Stride(const DepthView& view, const DepthImage& image, double voxel_size) {
  std::vector<std::uint16_t> measured;
  for (std::size_t i = 0; i < image.values.size(); i += 7) {
    if (image.values[i] != 0) measured.push_back(image.values[i]);
  }
  if (measured.empty()) return 1;
  const auto middle = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
  std::nth_element(measured.begin(), middle, measured.end());
  const double pixel = *middle * view.metres_per_unit / std::abs(view.camera.fx);
  return std::clamp(static_cast<int>(voxel_size / (kPixelsPerVoxel * pixel)), 1, 16);
}

/// The surface that one view sees.
void AddSurface(const DepthView& view, const DepthImage& image, double voxel_size,
                open3d::geometry::PointCloud& cloud) {
  const Camera& camera = view.camera;
  const RigidTransform world_from_camera = Inverse(camera.camera_from_world);
  const Matrix3d turn = world_from_camera.rotation.toRotationMatrix();
  const int stride = Stride(view, image, voxel_size);
  for (int y = 0; y < image.height; y += stride) {
    for (int x = 0; x < image.width; x += stride) {
      const std::uint16_t value = image.values[static_cast<std::size_t>(y) * image.width + x];
      if (value == 0) continue;
      const std::optional<LocalPlane> plane = PlaneAt(image, view.metres_per_unit, x, y);
      if (!plane) continue;
      const Vector3d point = camera.Unproject(Vector2d(x, y), value * view.metres_per_unit);
      const double ray_x = point.x() / point.z(), ray_y = point.y() / point.z();
      // n . p = 1 on the plane; it looks away from the camera.
      const Vector3d normal(plane->across * camera.fx, plane->down * camera.fy,
                            plane->at - plane->across * camera.fx * ray_x - plane->down * camera.fy * ray_y);
      cloud.points_.emplace_back(turn * point + world_from_camera.translation);
      cloud.normals_.emplace_back(turn * -normal.normalized());
    }
  }
}

Expected<DepthImage> ReadView(const DepthView& view, int frame) {
  Expected<DepthImage> image = ReadDepthImage(view.files[frame]);
  if (!image) return Forward(image);
  if (Status fits = CheckImage(view, frame, *image); !fits) return Forward(fits);
  if (Status masked = ApplyMask(view, frame, *image); !masked) return Forward(masked);
  return image;
}

}  // namespace

Expected<Eigen::Matrix3Xd> BackProject(const DepthView& view, int frame) {
  const Expected<DepthImage> image = ReadView(view, frame);
  if (!image) return Forward(image);
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

Expected<std::vector<DepthImage>> ReadFrame(const std::vector<DepthView>& views, int frame) {
  std::vector<DepthImage> images;
  for (const DepthView& view : views) {
    Expected<DepthImage> image = ReadView(view, frame);
    if (!image) return Forward(image);
    images.push_back(std::move(*image));
  }
  return images;
}

Expected<FusedCloud> FuseImages(const std::vector<DepthView>& views, const std::vector<DepthImage>& images,
                                const FusionOptions& options) {
  open3d::utility::SetVerbosityLevel(open3d::utility::VerbosityLevel::Error);
  open3d::geometry::PointCloud cloud;
  for (std::size_t v = 0; v < views.size(); ++v) AddSurface(views[v], images[v], options.voxel_size, cloud);
  if (cloud.points_.empty()) return FusedCloud{Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xd(3, 0), 0};
  try {
    return ThinAndClean(cloud, options);
  } catch (const std::exception& error) {
    return Fail(ErrorCode::kInconsistent, std::string("the point cloud cannot be thinned: ") + error.what(),
                "depth views", "try a larger voxel_size");
  }
}

Expected<FusedCloud> FuseViews(const std::vector<DepthView>& views, int frame, const FusionOptions& options) {
  const Expected<std::vector<DepthImage>> images = ReadFrame(views, frame);
  if (!images) return Forward(images);
  return FuseImages(views, *images, options);
}

}  // namespace mocurate
