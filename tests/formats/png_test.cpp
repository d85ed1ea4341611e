#include "core/formats/png.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/formats/damage.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

DepthImage Slope() {
  DepthImage image{64, 48, {}};
  for (int i = 0; i < 64 * 48; ++i) image.values.push_back(static_cast<std::uint16_t>(500 + (i * 37) % 4000));
  return image;
}

std::string FromHex(const std::string& digits) {
  std::string bytes;
  for (std::size_t i = 0; i < digits.size(); i += 2)
    bytes += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  return bytes;
}

/// Interlaced, 5 x 3 pixels, 2-bit grey, with a time chunk: rows 0 1 2 3 0, 0 1 2 3 0, 3 3 3 3 3.
const std::string kInterlaced = FromHex(
    "89504e470d0a1a0a0000000d494844520000000500000003020000000143eab2130000000774494d4507e40101000000c4ddbde10000001549"
    "44"
    "415478da6360008206863f0c050c1f18a41900138502f85d8b0cd00000000049454e44ae426082");
/// A palette of red and green, 2 x 2 pixels of 1 bit: red green, green red.
const std::string kPalette = FromHex(
    "89504e470d0a1a0a0000000d494844520000000200000002010300000048789f6700000006504c5445ff000000ff00d287ef710000000c4944"
    "41"
    "5478da637060680000014400c10487cffa0000000049454e44ae426082");

/// 16384 x 4096 pixels of 16 bits, 128 MiB, of which there are 9 bytes.
const std::string kLarge = FromHex(
    "89504e470d0a1a0a0000000d4948445200004000000010001000000000ffe67aac0000000b49444154789c636080020000090001fb52b8"
    "a90000000049454e44ae426082");

/// The place that CheckPng reports; "whole" without an error.
std::string Place(const std::string& bytes) {
  const Status checked = CheckPng(bytes, "d.png");
  EXPECT_EQ(checked.has_value(), DecodePng(bytes, "d.png").has_value());
  if (checked) return "whole";
  EXPECT_EQ(checked.error().code, ErrorCode::kMalformed);
  return checked.error().where;
}

TEST(Png, RoundTripsADepthImage) {
  const DepthImage image = Slope();
  const std::string bytes = EncodePng(image).value();
  EXPECT_EQ(bytes, EncodePng(image).value());
  const auto read = DecodeDepthPng(bytes, "d.png");
  ASSERT_TRUE(read) << read.error().Message();
  EXPECT_EQ(read->width, 64);
  EXPECT_EQ(read->height, 48);
  EXPECT_EQ(read->values, image.values);
  EXPECT_FALSE(EncodePng(DepthImage{4, 4, {1, 2}}));
  EXPECT_FALSE(EncodePng(DepthImage{}));
}

TEST(Png, RejectsAnImageThatTakesMoreMemoryThanTheFileMay) { EXPECT_EQ(Place(kLarge), "d.png:IHDR"); }

TEST(Png, ReadsTheHeaderFromTheFirstBytesOfAFile) {
  const std::string bytes = EncodePng(Slope()).value();
  const auto header = ReadPngHeader(bytes.substr(0, kPngHeaderBytes), "d.png");
  ASSERT_TRUE(header) << header.error().Message();
  EXPECT_THAT((std::vector<int>{header->width, header->height, header->bits, header->channels}),
              ElementsAre(64, 48, 16, 1));
  EXPECT_EQ(ReadPngHeader(kPalette, "p.png")->channels, 1);
  EXPECT_EQ(ReadPngHeader(kPalette, "p.png")->bits, 1);
  for (std::size_t size = 0; size < kPngHeaderBytes; ++size) {
    EXPECT_FALSE(ReadPngHeader(bytes.substr(0, size), "d.png")) << size;
    std::string damaged = bytes;
    damaged[size] = static_cast<char>(damaged[size] ^ 0x10);
    EXPECT_FALSE(ReadPngHeader(damaged, "d.png")) << size;
  }
}

TEST(Png, DecodesPalettesAndInterlacedImages) {
  const auto grey = DecodePng(kInterlaced, "g.png");
  ASSERT_TRUE(grey) << grey.error().Message();
  EXPECT_EQ(grey->header.bits, 8);
  EXPECT_THAT(grey->bytes, ElementsAre(0, 85, 170, 255, 0, 0, 85, 170, 255, 0, 255, 255, 255, 255, 255));
  const auto colours = DecodePng(kPalette, "p.png");
  ASSERT_TRUE(colours) << colours.error().Message();
  EXPECT_EQ(colours->header.channels, 3);
  EXPECT_THAT(colours->bytes, ElementsAre(255, 0, 0, 0, 255, 0, 0, 255, 0, 255, 0, 0));
  EXPECT_EQ(Place(kInterlaced), "whole");
  EXPECT_EQ(Place(kPalette), "whole");
  ExpectMalformed(DecodeDepthPng(kPalette, "p.png"), "p.png");
}

TEST(Png, NamesTheDamagedChunk) {
  const std::string png = EncodePng(Slope()).value();
  EXPECT_EQ(Place(png), "whole");
  EXPECT_EQ(Place(png + "what follows the end"), "whole");
  EXPECT_EQ(Place("GIF89a, and no PNG"), "d.png");
  EXPECT_EQ(Place(png.substr(0, 20)), "d.png:IHDR");
  EXPECT_EQ(Place(png.substr(0, png.size() / 2)), "d.png:IDAT");
  EXPECT_EQ(Place(png.substr(0, png.size() - 12)), "d.png:IEND");
  EXPECT_EQ(Place(png.substr(0, png.size() - 2)), "d.png:IEND");
  for (std::size_t at = 8; at < png.size(); at += 97) {
    std::string damaged = png;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    EXPECT_NE(Place(damaged), "whole") << at;
    EXPECT_NE(Place(png.substr(0, at)), "whole") << at;
  }
  std::string time = kInterlaced;
  time[42] ^= 1;
  EXPECT_EQ(Place(time), "d.png:tIME");
}

TEST(Png, RejectsAnImageWithFewerRowsThanDeclared) {
  const std::string tall = EncodePng(Slope()).value();
  DepthImage half = Slope();
  half.height = 24;
  half.values.resize(64 * 24);
  const std::string low = EncodePng(half).value();
  EXPECT_EQ(Place(tall.substr(0, kPngHeaderBytes) + low.substr(kPngHeaderBytes)), "d.png:IDAT");
  EXPECT_EQ(Place(low.substr(0, kPngHeaderBytes) + tall.substr(kPngHeaderBytes)), "d.png:IDAT");
}

TEST(Png, RejectsDamagedRecordedImages) {
  MOCURATE_RECORDED(png, "clouds/rendered_body/male_tpose_d3.png");
  EXPECT_EQ(Place(png), "whole");
  for (std::size_t at = 0; at < png.size(); at += 211) {
    std::string damaged = png;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    EXPECT_NE(Place(damaged), "whole") << at;
    EXPECT_NE(Place(png.substr(0, at)), "whole") << at;
  }
}

}  // namespace
}  // namespace mocurate
