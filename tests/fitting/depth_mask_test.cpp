// Depth images with masks of the person: what lies outside is no point of the cloud.

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/sha256.h"
#include "fitting/clouds/depth_fusion.h"
#include "tests/fitting/cloud_scene.h"

namespace mocurate {
namespace {

using ::testing::HasSubstr;

std::string BigEndian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xFF);
  return bytes;
}

std::string Chunk(const std::string& name, const std::string& data) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const char c : name + data) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) != 0 ? 0xEDB88320u ^ (crc >> 1) : crc >> 1;
  }
  return BigEndian(static_cast<std::uint32_t>(data.size())) + name + data + BigEndian(crc ^ 0xFFFFFFFFu);
}

/// A PNG of one 8-bit channel, not compressed. At most 255 x 255 pixels.
std::string GreyPng(int width, int height, const std::vector<std::uint8_t>& pixels) {
  std::string raw;
  for (int y = 0; y < height; ++y) {
    raw += '\0';
    for (int x = 0; x < width; ++x) raw += static_cast<char>(pixels[static_cast<std::size_t>(y) * width + x]);
  }
  std::uint32_t a = 1, b = 0;
  for (const char c : raw) a = (a + static_cast<unsigned char>(c)) % 65521, b = (b + a) % 65521;
  const auto size = static_cast<std::uint16_t>(raw.size());
  std::string stored("\x78\x01\x01");
  for (const std::uint16_t length : {size, static_cast<std::uint16_t>(~size)}) {
    stored += static_cast<char>(length & 0xFF);
    stored += static_cast<char>(length >> 8);
  }
  stored += raw + BigEndian(b << 16 | a);
  const std::string header = BigEndian(static_cast<std::uint32_t>(width)) +
                             BigEndian(static_cast<std::uint32_t>(height)) + std::string("\x08\x00\x00\x00\x00", 5);
  return "\x89PNG\r\n\x1a\n" + Chunk("IHDR", header) + Chunk("IDAT", stored) + Chunk("IEND", "");
}

/// A wall two metres before a camera of 20 x 10 pixels; the person is what the mask says.
class MaskedDepth : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) / ("mocurate_masks_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    view_.camera.name = "front";
    view_.camera.width = 20, view_.camera.height = 10;
    view_.camera.fx = view_.camera.fy = 20.0;
    view_.camera.cx = 9.5, view_.camera.cy = 4.5;
    view_.metres_per_unit = 0.001;
    view_.files = {folder_ / "depth.png"};
    view_.time_s = {0.0};
    ASSERT_TRUE(WriteDepthImage(DepthImage{20, 10, std::vector<std::uint16_t>(200, 2000)}, view_.files[0]));
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

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

  std::filesystem::path folder_;
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

TEST_F(MaskedDepth, HalfWayIsTheEdge) {
  std::vector<std::uint8_t> pixels(200, 127);
  pixels[7] = 128;
  Mask(20, 10, pixels);
  const auto points = BackProject(view_, 0);
  ASSERT_TRUE(points) << points.error().Message();
  EXPECT_EQ(points->cols(), 1);
}

TEST_F(MaskedDepth, AMaskThatShowsNobodyGivesAnEmptyCloud) {
  Mask(20, 10, std::vector<std::uint8_t>(200, 0));
  const auto cloud = FuseViews({view_}, 0, FusionOptions());
  ASSERT_TRUE(cloud) << cloud.error().Message();
  EXPECT_EQ(cloud->size(), 0);
}

TEST_F(MaskedDepth, AMaskOfAnotherImageIsRefusedByName) {
  Mask(10, 20, std::vector<std::uint8_t>(200, 255));
  EXPECT_THAT(Refused(), HasSubstr("mask.png: 10 x 20 pixels, the depth image has 20 x 10"));
}

TEST_F(MaskedDepth, AMaskThatChangedOrIsGoneIsRefusedByName) {
  Mask(20, 10, std::vector<std::uint8_t>(200, 255));
  EXPECT_EQ(Refused(), "");
  ASSERT_TRUE(WriteFile(view_.masks[0], GreyPng(20, 10, std::vector<std::uint8_t>(200, 200))));
  EXPECT_THAT(Refused(), HasSubstr("mask.png: the file has changed since it was ingested"));
  std::filesystem::remove(view_.masks[0]);
  EXPECT_THAT(Refused(), HasSubstr("mask.png: the mask does not exist"));
  ASSERT_TRUE(WriteDepthImage(DepthImage{20, 10, std::vector<std::uint16_t>(200, 1)}, view_.masks[0]));
  EXPECT_THAT(Refused(), HasSubstr("a mask has channels of 8 bits"));
}

}  // namespace
}  // namespace mocurate
