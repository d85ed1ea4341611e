#include "fitting/clouds/depth_fusion.h"

#include <open3d/geometry/Image.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/io/ImageIO.h>
#include <open3d/utility/Logging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/formats/png.h"
#include "fitting/clouds/depth_normals.h"

namespace mocurate {
namespace {

constexpr int kHalfWindow = 2;           ///< pixels on each side, for normals (numerical)
constexpr double kFewestOfWindow = 0.6;  ///< share of the window that must lie on the surface; else the pixel is an
                                         ///< outlier
constexpr double kSurface = 0.04;        ///< m in depth; farther neighbours are of another surface
constexpr double kPixelsPerVoxel = 2.0;  ///< pixels sampled per voxel, along each axis (numerical)

/// Sets pixels outside the mask to not measured.
Status ApplyMask(const DepthView& view, int frame, DepthImage& image) {
  if (view.masks.empty()) return {};
  const std::filesystem::path& file = view.masks[frame];
  const Expected<PixelMask> mask = ReadPixelMask(file);
  if (!mask) return Forward(mask);
  if (mask->width != image.width || mask->height != image.height) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(mask->width) + " x " + std::to_string(mask->height) + " pixels, the depth image has " +
                    std::to_string(image.width) + " x " + std::to_string(image.height),
                file.string(), "check that the mask is for this image");
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
                file, "check that the image is from this camera");
  }
  return CheckUnchanged(view.files[frame], static_cast<int>(view.sha256.size()) > frame ? view.sha256[frame] : "");
}

/// Sorted copy of a cloud: Open3D's voxel order depends on a hash map.
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
    if (cloud.HasNormals()) sorted.normals.col(i) = cloud.normals_[order[i]];
  }
  return sorted;
}

Eigen::Matrix3Xd AsMatrix(const std::vector<Vector3d>& points) {
  return Eigen::Map<const Eigen::Matrix3Xd>(points.data()->data(), 3, static_cast<Eigen::Index>(points.size()));
}

FusedCloud Thin(const open3d::geometry::PointCloud& cloud, double voxel_size) {
  auto thin = cloud.VoxelDownSample(voxel_size);
  thin->NormalizeNormals();
  FusedCloud sorted = Sorted(*thin);
  if (!thin->HasNormals()) EstimateNormals(AsMatrix(cloud.points_), voxel_size, sorted);
  return sorted;
}

Expected<FusedCloud> Fuse(const open3d::geometry::PointCloud& cloud, double voxel_size, const char* what) {
  open3d::utility::SetVerbosityLevel(open3d::utility::VerbosityLevel::Error);
  if (cloud.points_.empty()) return FusedCloud();
  try {
    return Thin(cloud, voxel_size);
  } catch (const std::exception& error) {
    return Fail(ErrorCode::kInconsistent, std::string("the point cloud cannot be thinned: ") + error.what(), what,
                "try a larger voxel_size");
  }
}

/// The surface at a pixel. On a plane, inverse depth is linear in the pixel: 1/z = at + across du + down dv.
struct LocalPlane {
  double at = 0.0;
  double across = 0.0;
  double down = 0.0;
};

/// Least-squares plane over the window. Empty when too few neighbours are on the pixel's surface.
std::optional<LocalPlane> PlaneAt(const DepthImage& image, double metres_per_unit, int x, int y) {
  const std::uint16_t* const middle = image.values.data() + static_cast<std::size_t>(y) * image.width + x;
  const int near = static_cast<int>(std::min(kSurface / metres_per_unit + 1e-6, 65535.0));
  const int left = std::max(-kHalfWindow, -x), right = std::min(kHalfWindow, image.width - 1 - x);
  const int up = std::max(-kHalfWindow, -y), down = std::min(kHalfWindow, image.height - 1 - y);
  // Offsets are integers; inverse depths are in 1 / unit.
  int n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
  double r = 0.0, rx = 0.0, ry = 0.0;
  for (int dy = up; dy <= down; ++dy) {
    const std::uint16_t* const row = middle + static_cast<std::ptrdiff_t>(dy) * image.width;
    for (int dx = left; dx <= right; ++dx) {
      const int value = row[dx];
      if (value == 0 || std::abs(value - *middle) > near) continue;
      const double inverse = 1.0 / value;
      ++n, sx += dx, sy += dy, sxx += dx * dx, sxy += dx * dy, syy += dy * dy;
      r += inverse, rx += dx * inverse, ry += dy * inverse;
    }
  }
  constexpr int kWindow = (2 * kHalfWindow + 1) * (2 * kHalfWindow + 1);  ///< pixels of the window (numerical)
  if (n < kFewestOfWindow * kWindow) return std::nullopt;
  // Relative to the mean offset.
  const double xx = n * sxx - sx * sx, xy = n * sxy - sx * sy, yy = n * syy - sy * sy;
  const double bx = n * rx - sx * r, by = n * ry - sy * r;
  const double scale = 1.0 / (metres_per_unit * (xx * yy - xy * xy));
  const double across = (yy * bx - xy * by) * scale, down_slope = (xx * by - xy * bx) * scale;
  return LocalPlane{(r / metres_per_unit - across * sx - down_slope * sy) / n, across, down_slope};
}

/// Pixel step that suffices for one point per voxel.
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

/// Normal of a plane in front of the camera, n . p = 1; n looks away from the camera.
Vector3d NormalOf(const LocalPlane& plane, const Camera& camera, const Vector3d& point) {
  const double ray_x = point.x() / point.z(), ray_y = point.y() / point.z();
  return {plane.across * camera.fx, plane.down * camera.fy,
          plane.at - plane.across * camera.fx * ray_x - plane.down * camera.fy * ray_y};
}

/// Adds the surface of one view.
void AddSurface(const DepthView& view, const DepthImage& image, double voxel_size,
                open3d::geometry::PointCloud& cloud) {
  const Camera& camera = view.camera;
  const RigidTransform world_from_camera = Inverse(camera.camera_from_world);
  const Matrix3d rotation = world_from_camera.rotation.toRotationMatrix();
  const int stride = Stride(view, image, voxel_size);
  for (int y = 0; y < image.height; y += stride) {
    for (int x = 0; x < image.width; x += stride) {
      const std::uint16_t value = image.values[static_cast<std::size_t>(y) * image.width + x];
      if (value == 0) continue;
      const std::optional<LocalPlane> plane = PlaneAt(image, view.metres_per_unit, x, y);
      if (!plane) continue;
      const Vector3d point = camera.Unproject(Vector2d(x, y), value * view.metres_per_unit);
      cloud.points_.emplace_back(rotation * point + world_from_camera.translation);
      cloud.normals_.emplace_back(rotation * -NormalOf(*plane, camera, point).normalized());
    }
  }
}

Expected<DepthImage> ReadDepthFrame(const DepthView& view, int frame) {
  if (view.files[frame].empty()) {
    const auto pixels = static_cast<std::size_t>(view.camera.width) * static_cast<std::size_t>(view.camera.height);
    return DepthImage{view.camera.width, view.camera.height, std::vector<std::uint16_t>(pixels, 0)};
  }
  Expected<DepthImage> image = ReadDepthImage(view.files[frame]);
  if (!image) return Forward(image);
  if (Status fits = CheckImage(view, frame, *image); !fits) return Forward(fits);
  if (Status masked = ApplyMask(view, frame, *image); !masked) return Forward(masked);
  return image;
}

}  // namespace

Status CheckUnchanged(const std::filesystem::path& file, const std::string& hash) {
  if (hash.empty()) return {};
  const Expected<std::string> now = Sha256OfFile(file);
  if (!now) return Forward(now);
  if (*now == hash) return {};
  return Fail(ErrorCode::kInconsistent, "the file has changed since it was ingested", file.string(), "ingest it again");
}

std::vector<bool> CoverageSample(const FusedCloud& cloud, double voxel_size) {
  std::vector<bool> sample(static_cast<std::size_t>(cloud.size()), true);
  if (voxel_size >= kCoverageCell || cloud.size() == 0) return sample;
  const Vector3d origin = cloud.points.rowwise().minCoeff() - Vector3d::Constant(0.5 * kCoverageCell);
  std::set<std::array<int, 3>> occupied;
  for (int i = 0; i < cloud.size(); ++i) {
    const Vector3d cell = (cloud.points.col(i) - origin) / kCoverageCell;
    sample[static_cast<std::size_t>(i)] =
        occupied.insert({static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())}).second;
  }
  return sample;
}

double SpacingOf(const FusedCloud& cloud, double voxel_size) {
  if (voxel_size >= kCoverageCell || cloud.size() == 0) return voxel_size;
  const std::vector<bool> sample = CoverageSample(cloud, voxel_size);
  const auto cells = static_cast<double>(std::count(sample.begin(), sample.end(), true));
  return std::max(voxel_size, kCoverageCell * std::sqrt(cells / cloud.size()));
}

FusedCloud ChosenPoints(const FusedCloud& cloud, const std::vector<int>& points) {
  const auto count = static_cast<Eigen::Index>(points.size());
  FusedCloud chosen{Eigen::Matrix3Xd(3, count), Eigen::Matrix3Xd(3, count), 0, cloud.spacing};
  for (Eigen::Index i = 0; i < count; ++i) {
    chosen.points.col(i) = cloud.points.col(points[static_cast<std::size_t>(i)]);
    chosen.normals.col(i) = cloud.normals.col(points[static_cast<std::size_t>(i)]);
  }
  return chosen;
}

FusedCloud CoarseCloud(const FusedCloud& cloud, int count) {
  std::vector<int> points;
  for (int i = 0; i < cloud.size(); i += std::max(1, cloud.size() / count)) points.push_back(i);
  return ChosenPoints(cloud, points);
}

std::optional<PixelPlane> PlaneAtPixel(const DepthView& view, const DepthImage& image, int x, int y) {
  const std::optional<LocalPlane> plane = PlaneAt(image, view.metres_per_unit, x, y);
  if (!plane || plane->at <= 0.0) return std::nullopt;
  const Vector3d point = view.camera.Unproject(Vector2d(x, y), 1.0 / plane->at);
  return PixelPlane{point, -NormalOf(*plane, view.camera, point).normalized()};
}

Expected<std::vector<DepthImage>> ReadFrame(const std::vector<DepthView>& views, int frame) {
  std::vector<DepthImage> images;
  for (const DepthView& view : views) {
    Expected<DepthImage> image = ReadDepthFrame(view, frame);
    if (!image) return Forward(image);
    images.push_back(std::move(*image));
  }
  return images;
}

Expected<FusedCloud> FuseImages(const std::vector<DepthView>& views, const std::vector<DepthImage>& images,
                                double voxel_size) {
  open3d::geometry::PointCloud cloud;
  for (std::size_t v = 0; v < views.size(); ++v) AddSurface(views[v], images[v], voxel_size, cloud);
  return Fuse(cloud, voxel_size, "depth views");
}

Expected<FusedCloud> FusePoints(std::vector<Vector3d> points, std::vector<Vector3d> normals, double voxel_size) {
  open3d::geometry::PointCloud cloud;
  cloud.points_ = std::move(points);
  cloud.normals_ = std::move(normals);
  return Fuse(cloud, voxel_size, "point clouds");
}

Expected<FusedCloud> FuseViews(const std::vector<DepthView>& views, int frame, double voxel_size) {
  const Expected<std::vector<DepthImage>> images = ReadFrame(views, frame);
  if (!images) return Forward(images);
  return FuseImages(views, *images, voxel_size);
}

namespace {

/// Bytes of the pixels that a JPEG declares in the header of its frame; empty where it has none.
std::optional<std::uint64_t> DeclaredPixels(const std::string& jpeg) {
  const auto byte = [&jpeg](std::size_t at) -> std::uint64_t { return static_cast<unsigned char>(jpeg[at]); };
  for (std::size_t at = 2; at + 10 <= jpeg.size() && byte(at) == 0xFF;) {
    const std::uint64_t marker = byte(at + 1);
    const bool frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (frame) return (byte(at + 5) << 8 | byte(at + 6)) * (byte(at + 7) << 8 | byte(at + 8)) * byte(at + 9);
    at += marker == 0xFF ? 1 : 2 + (byte(at + 2) << 8 | byte(at + 3));  // a filling byte, or a segment
  }
  return std::nullopt;
}

Expected<PngImage> ReadJpeg(const std::string& bytes, const std::filesystem::path& path) {
  const auto pixels = DeclaredPixels(bytes);
  if (pixels && *pixels > MostUnpacked(bytes.size())) {
    return Fail(ErrorCode::kMalformed,
                "the image unpacks to " + std::to_string(*pixels) + " bytes; a file of " +
                    std::to_string(bytes.size()) + " bytes may hold " + std::to_string(MostUnpacked(bytes.size())),
                path.string(), "make the image smaller");
  }
  open3d::utility::SetVerbosityLevel(open3d::utility::VerbosityLevel::Error);  // standard output is for documents
  try {
    open3d::geometry::Image image;
    if (pixels && open3d::io::ReadImageFromJPG(path.string(), image) && image.HasData())
      return PngImage{{image.width_, image.height_, 8, image.num_of_channels_}, std::move(image.data_)};
  } catch (const std::exception&) {
    // Reported below.
  }
  return Fail(ErrorCode::kMalformed, "not a PNG or JPEG image, or damaged", path.string(), "copy it again");
}

}  // namespace

Expected<PixelMask> ReadPixelMask(const std::filesystem::path& path) {
  const Expected<std::string> bytes = ReadFile(path);
  if (!bytes) return Forward(bytes);
  const bool is_png = bytes->compare(0, 4, "\x89PNG") == 0;
  const Expected<PngImage> image = is_png ? DecodePng(*bytes, path.string()) : ReadJpeg(*bytes, path);
  if (!image) return Forward(image);
  if (image->header.bits != 8) return Fail(ErrorCode::kMalformed, "a mask has channels of 8 bits", path.string());
  PixelMask mask{image->header.width, image->header.height, {}};
  const auto channels = static_cast<std::size_t>(image->header.channels);
  for (std::size_t i = 0; i < image->bytes.size(); i += channels) mask.inside.push_back(image->bytes[i] >= 128 ? 1 : 0);
  return mask;
}

Expected<DepthImage> ReadDepthImage(const std::filesystem::path& path) {
  const Expected<std::string> bytes = ReadFile(path);
  return bytes ? DecodeDepthPng(*bytes, path.string()) : Forward(bytes);
}

}  // namespace mocurate
