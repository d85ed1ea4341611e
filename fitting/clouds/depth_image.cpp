#include "fitting/clouds/depth_image.h"

#include <open3d/geometry/Image.h>
#include <open3d/io/ImageIO.h>
#include <open3d/utility/Logging.h>

#include <cstring>
#include <exception>
#include <fstream>
#include <string>

namespace mocurate {
namespace {

/// Open3D tells of failures on standard output, which belongs to documents.
void Silence() { open3d::utility::SetVerbosityLevel(open3d::utility::VerbosityLevel::Error); }

bool ReadPng(const std::filesystem::path& path, open3d::geometry::Image& image) {
  Silence();
  try {
    return open3d::io::ReadImageFromPNG(path.string(), image) && image.HasData();
  } catch (const std::exception&) {
    return false;
  }
}

bool ReadJpeg(const std::filesystem::path& path, open3d::geometry::Image& image) {
  Silence();
  try {
    return open3d::io::ReadImageFromJPG(path.string(), image) && image.HasData();
  } catch (const std::exception&) {
    return false;
  }
}

bool IsPng(const std::filesystem::path& path) {
  char head[4] = {};
  std::ifstream(path, std::ios::binary).read(head, sizeof head);
  return std::memcmp(head, "\x89PNG", sizeof head) == 0;
}

Status Exists(const std::filesystem::path& path, const char* what) {
  std::error_code error;
  if (std::filesystem::exists(path, error)) return {};
  return Fail(ErrorCode::kNotFound, std::string("the ") + what + " does not exist", path.string(),
              "is the folder complete?");
}

}  // namespace

Expected<PixelMask> ReadPixelMask(const std::filesystem::path& path) {
  if (Status there = Exists(path, "mask"); !there) return Forward(there);
  open3d::geometry::Image image;
  if (!(IsPng(path) ? ReadPng(path, image) : ReadJpeg(path, image))) {
    return Fail(ErrorCode::kUnreadable, "no PNG or JPEG image, or a damaged one", path.string());
  }
  if (image.bytes_per_channel_ != 1) {
    return Fail(ErrorCode::kMalformed, "a mask has channels of 8 bits", path.string());
  }
  PixelMask mask{image.width_, image.height_, {}};
  const auto channels = static_cast<std::size_t>(image.num_of_channels_);
  for (std::size_t i = 0; i < image.data_.size(); i += channels) mask.inside.push_back(image.data_[i] >= 128 ? 1 : 0);
  return mask;
}

Expected<DepthImage> ReadDepthImage(const std::filesystem::path& path) {
  if (Status there = Exists(path, "depth image"); !there) return Forward(there);
  open3d::geometry::Image image;
  if (!ReadPng(path, image)) {
    return Fail(ErrorCode::kUnreadable, "no PNG image, or a damaged one", path.string(),
                "copy it again from where it came, or leave the clip out");
  }
  if (image.num_of_channels_ != 1 || image.bytes_per_channel_ != 2) {
    return Fail(ErrorCode::kMalformed,
                std::to_string(image.num_of_channels_) + " channels of " +
                    std::to_string(8 * image.bytes_per_channel_) + " bits, a depth image has one of 16",
                path.string());
  }
  DepthImage depth{image.width_, image.height_, {}};
  depth.values.resize(static_cast<std::size_t>(depth.width) * depth.height);
  std::memcpy(depth.values.data(), image.data_.data(), depth.values.size() * sizeof(std::uint16_t));
  return depth;
}

Status WriteDepthImage(const DepthImage& image, const std::filesystem::path& path) {
  Silence();
  open3d::geometry::Image png;
  png.Prepare(image.width, image.height, 1, 2);
  std::memcpy(png.data_.data(), image.values.data(), image.values.size() * sizeof(std::uint16_t));
  try {
    if (open3d::io::WriteImageToPNG(path.string(), png)) return {};
  } catch (const std::exception&) {
    // Told below.
  }
  return Fail(ErrorCode::kCannotWrite, "the depth image cannot be written", path.string(),
              "check that the folder exists, is writable and has room");
}

}  // namespace mocurate
