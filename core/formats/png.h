#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/camera.h"

namespace mocurate {

/// Images as PNG, by libpng. Errors: kMalformed at the chunk that is damaged or missing, "depth.png:IDAT".

struct PngHeader {
  int width = 0;
  int height = 0;
  int bits = 0;      ///< per sample
  int channels = 0;  ///< 1 for grey and for a palette, 2 with alpha, 3 or 4 for colours
};

/// A file begins with its header; the bytes behind it are not read.
constexpr std::size_t kPngHeaderBytes = 33;
Expected<PngHeader> ReadPngHeader(std::string_view bytes, const std::string& name);

/// Samples row by row, channels interleaved, of 8 or 16 bits (16: low byte first). A palette is resolved, fewer bits
/// are scaled to 8.
struct PngImage {
  PngHeader header;
  std::vector<std::uint8_t> bytes;
};

/// Also kMalformed: sides of more than 16,384 pixels.
Expected<PngImage> DecodePng(std::string_view bytes, const std::string& name);

/// A depth image: one channel of 16 bits, else kMalformed.
Expected<DepthImage> DecodeDepthPng(std::string_view bytes, const std::string& name);

/// Whether an image of any type and size is complete: every chunk agrees with its checksum, and there are as many
/// pixels as the header declares. The image is not kept.
Status CheckPng(std::string_view bytes, const std::string& name);

/// A depth image as PNG of one 16-bit channel (rows filtered by the one above, deflate). Same image, same bytes with
/// one version of libpng and zlib. Error kInconsistent: the count of values is not width times height, or that is 0.
Expected<std::string> EncodePng(const DepthImage& image);

}  // namespace mocurate
