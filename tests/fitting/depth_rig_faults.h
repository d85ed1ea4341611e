#pragma once

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/base/file.h"
#include "core/base/random.h"
#include "core/motion/clip.h"
#include "fitting/clouds/depth_fusion.h"
#include "tests/support/depth_files.h"

namespace mocurate {

/// The camera moved by `moved_m` metres and rotated by `rotated_deg` degrees, both in random directions.
inline Camera Knocked(Camera camera, double moved_m, double rotated_deg, Random& random) {
  const auto direction = [&] { return Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized(); };
  const Vector3d offset = moved_m * direction();
  const Vector3d rotation = rotated_deg / 57.29577951308232 * direction();
  camera.camera_from_world = RigidTransform{ExpQuaternion(rotation), offset} * camera.camera_from_world;
  return camera;
}

/// View `late` shows what happened `frames` frames earlier (negative: later); all views are cut to the common range.
inline std::vector<DepthView> WithClockOffset(std::vector<DepthView> views, std::size_t late, int frames) {
  const std::size_t by = static_cast<std::size_t>(std::abs(frames));
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto cut = [&](auto& list) {
      if (list.size() <= by) return;
      if ((v == late) == (frames > 0)) {
        list.resize(list.size() - by);
      } else {
        list.erase(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(by));
      }
    };
    cut(views[v].files), cut(views[v].sha256), cut(views[v].masks), cut(views[v].mask_sha256);
    views[v].time_s.resize(views[v].files.size());
  }
  return views;
}

inline void ExchangeFiles(DepthView& a, DepthView& b) {
  std::swap(a.files, b.files);
  std::swap(a.sha256, b.sha256);
  std::swap(a.masks, b.masks);
  std::swap(a.mask_sha256, b.mask_sha256);
}

/// The same views with every image mirrored, written to `folder`: x counts from the right.
inline Expected<std::vector<DepthView>> WithMirroredImages(std::vector<DepthView> views,
                                                           const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (DepthView& view : views) {
    view.sha256.clear();
    for (std::filesystem::path& file : view.files) {
      Expected<DepthImage> image = ReadDepthImage(file);
      if (!image) return Forward(image);
      for (int y = 0; y < image->height; ++y) {
        const auto row = image->values.begin() + static_cast<std::ptrdiff_t>(y) * image->width;
        std::reverse(row, row + image->width);
      }
      file = folder / (view.camera.name + "_" + file.filename().string());
      if (Status written = WriteDepthImage(*image, file); !written) return Forward(written);
    }
  }
  return views;
}

/// The numbers of a matrix in an OpenCV XML file.
inline std::vector<double> MatrixOf(const std::string& bytes, const std::string& name) {
  const std::size_t begin = bytes.find("<data>", bytes.find("<" + name)) + 6;
  std::istringstream text(bytes.substr(begin, bytes.find("</data>", begin) - begin));
  return {std::istream_iterator<double>(text), {}};
}

/// Head and upper body of one person from 80 sides, as configs/sources/rgbd100.yaml reads them. The person rotated
/// before a fixed sensor; the world is y down.
inline Expected<std::vector<DepthView>> TurntableViews(const std::filesystem::path& folder) {
  const RigidTransform canonical{Quaterniond(Matrix3d(Vector3d(1, -1, -1).asDiagonal())), Vector3d::Zero()};
  std::vector<DepthView> views;
  for (int i = 0; i < 100; ++i) {
    if (i % 5 == 2) continue;
    char number[16];
    std::snprintf(number, sizeof number, "%010d", i);
    const std::string stem = number;
    const auto bytes = ReadFile(folder / (stem + "_camera.xml"));
    if (!bytes) return Forward(bytes);
    const std::vector<double> r = MatrixOf(*bytes, "R"), t = MatrixOf(*bytes, "t");
    if (r.size() != 9 || t.size() != 3) return Fail(ErrorCode::kMalformed, "R or t is missing", stem);
    Matrix3d rotation;
    rotation << r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8];
    const RigidTransform world_from_camera{Quaterniond(rotation).normalized(), Vector3d(t[0], t[1], t[2])};
    DepthView view;
    view.camera = {stem, 640, 480, 525.0, 525.0, 320.0, 240.0, {}, {}};
    view.camera.camera_from_world = Inverse(canonical * world_from_camera);
    view.files = {folder / (stem + "_depth.png")};
    view.masks = {folder / (stem + "_mask.jpg")};
    view.mask_sha256 = {""};
    view.time_s = {0.0};
    views.push_back(view);
  }
  return views;
}

}  // namespace mocurate
