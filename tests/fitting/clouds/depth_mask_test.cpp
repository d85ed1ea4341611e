// Depth images with person masks: pixels outside the mask are not points of the cloud.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include "core/base/sha256.h"
#include "fitting/clouds/depth_fusion.h"
#include "tests/fitting/back_project.h"
#include "tests/fitting/cloud_scene.h"
#include "tests/support/depth_files.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

/// A PNG of one 8-bit channel.
std::string GreyPng(int width, int height, const std::vector<std::uint8_t>& pixels) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_GRAY;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  EXPECT_NE(png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr), 0);
  bytes.resize(size);
  return bytes;
}

/// A wall two metres before a camera of 20 x 10 pixels; the mask selects the person.
class MaskedDepth : public ::testing::Test {
 protected:
  void SetUp() override {
    view_.camera.name = "front";
    view_.camera.width = 20, view_.camera.height = 10;
    view_.camera.fx = view_.camera.fy = 20.0;
    view_.camera.cx = 9.5, view_.camera.cy = 4.5;
    view_.metres_per_unit = 0.001;
    view_.files = {folder_ / "depth.png"};
    view_.time_s = {0.0};
    ASSERT_TRUE(WriteDepthImage(DepthImage{20, 10, std::vector<std::uint16_t>(200, 2000)}, view_.files[0]));
  }
  void Mask(int width, int height, const std::vector<std::uint8_t>& pixels) {
    const std::string bytes = GreyPng(width, height, pixels);
    view_.masks = {folder_ / "mask.png"};
    view_.mask_sha256 = {Sha256Hex(bytes)};
    ASSERT_TRUE(WriteFile(view_.masks[0], bytes));
  }
  std::string Refused() {
    const auto points = BackProject(view_, 0);
    return points ? "" : points.error().Message();
  }

  ScratchFolder folder_;
  DepthView view_;
};

TEST_F(MaskedDepth, OnlyPixelsInsideTheMaskArePoints) {
  const auto all = BackProject(view_, 0);
  ASSERT_TRUE(all) << all.error().Message();
  EXPECT_EQ(all->cols(), 200);
  std::vector<std::uint8_t> pixels(200, 0);
  for (int y = 2; y < 5; ++y) {
    for (int x = 12; x < 16; ++x) pixels[static_cast<std::size_t>(y) * 20 + x] = 255;
  }
  Mask(20, 10, pixels);
  const auto points = BackProject(view_, 0);
  ASSERT_TRUE(points) << points.error().Message();
  ASSERT_EQ(points->cols(), 12);
  // Columns 12 to 15 and rows 2 to 4, 2 m away: x = 2 (u - 9.5) / 20, y = 2 (v - 4.5) / 20.
  EXPECT_NEAR(points->row(0).minCoeff(), 0.25, 1e-9);
  EXPECT_NEAR(points->row(0).maxCoeff(), 0.55, 1e-9);
  EXPECT_NEAR(points->row(1).minCoeff(), -0.25, 1e-9);
  EXPECT_NEAR(points->row(1).maxCoeff(), -0.05, 1e-9);
}

TEST_F(MaskedDepth, MaskThresholdIsHalfOfTheRange) {
  std::vector<std::uint8_t> pixels(200, 127);
  pixels[7] = 128;
  Mask(20, 10, pixels);
  const auto points = BackProject(view_, 0);
  ASSERT_TRUE(points) << points.error().Message();
  EXPECT_EQ(points->cols(), 1);
}

TEST_F(MaskedDepth, EmptyMaskGivesAnEmptyCloud) {
  Mask(20, 10, std::vector<std::uint8_t>(200, 0));
  const auto cloud = FuseViews({view_}, 0, PointCloudOptions().voxel_size);
  ASSERT_TRUE(cloud) << cloud.error().Message();
  EXPECT_EQ(cloud->size(), 0);
}

TEST_F(MaskedDepth, RefusesAMaskOfAnotherSizeByName) {
  Mask(10, 20, std::vector<std::uint8_t>(200, 255));
  EXPECT_THAT(Refused(), HasSubstr("mask.png: 10 x 20 pixels, the depth image has 20 x 10"));
}

TEST_F(MaskedDepth, RefusesAChangedOrMissingMaskByName) {
  Mask(20, 10, std::vector<std::uint8_t>(200, 255));
  EXPECT_EQ(Refused(), "");
  ASSERT_TRUE(WriteFile(view_.masks[0], GreyPng(20, 10, std::vector<std::uint8_t>(200, 200))));
  EXPECT_THAT(Refused(), HasSubstr("mask.png: the file has changed since it was ingested"));
  std::filesystem::remove(view_.masks[0]);
  EXPECT_THAT(Refused(), HasSubstr("mask.png: no such file"));
  ASSERT_TRUE(WriteDepthImage(DepthImage{20, 10, std::vector<std::uint16_t>(200, 1)}, view_.masks[0]));
  EXPECT_THAT(Refused(), HasSubstr("a mask has channels of 8 bits"));
}

}  // namespace
}  // namespace mocurate
