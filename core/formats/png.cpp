#include "core/formats/png.h"

#include <zlib.h>

#include <cstdint>

namespace mocurate {
namespace {

void AppendBig(std::uint32_t value, std::string& bytes) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>((value >> shift) & 0xFF);
}

/// Length, type, data, CRC of type and data.
void AppendChunk(const char* type, const std::string& data, std::string& png) {
  AppendBig(static_cast<std::uint32_t>(data.size()), png);
  const std::string body = type + data;
  png += body;
  AppendBig(
      static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()))),
      png);
}

/// Each row behind its filter: 2, the difference to the row above byte by byte, modulo 256.
std::string FilteredRows(const DepthImage& image) {
  const auto width = static_cast<std::size_t>(image.width);
  std::string rows;
  rows.reserve((2 * width + 1) * static_cast<std::size_t>(image.height));
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    rows += '\2';
    for (std::size_t x = 0; x < width; ++x) {
      const std::uint16_t value = image.values[y * width + x];
      const std::uint16_t above = y > 0 ? image.values[(y - 1) * width + x] : std::uint16_t{0};
      rows += static_cast<char>((value >> 8) - (above >> 8));
      rows += static_cast<char>((value & 0xFF) - (above & 0xFF));
    }
  }
  return rows;
}

}  // namespace

Expected<std::string> EncodePng(const DepthImage& image) {
  const bool is_whole = image.width > 0 && image.height > 0 &&
                        image.values.size() == static_cast<std::size_t>(image.width) * image.height;
  if (!is_whole) {
    return Fail(ErrorCode::kInconsistent, std::to_string(image.values.size()) + " values are no image of " +
                                              std::to_string(image.width) + " x " + std::to_string(image.height));
  }
  const std::string rows = FilteredRows(image);
  uLongf size = compressBound(static_cast<uLong>(rows.size()));
  std::string packed(size, '\0');
  const int done = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                             reinterpret_cast<const Bytef*>(rows.data()), static_cast<uLong>(rows.size()), 3);
  if (done != Z_OK) return Fail(ErrorCode::kInternal, "zlib packed no image, error " + std::to_string(done));
  packed.resize(size);
  std::string header;
  AppendBig(static_cast<std::uint32_t>(image.width), header);
  AppendBig(static_cast<std::uint32_t>(image.height), header);
  header += std::string("\x10\x00\x00\x00\x00", 5);  // 16 bits, grey, deflate, the usual filters, not interlaced
  std::string png("\x89PNG\r\n\x1a\n", 8);
  AppendChunk("IHDR", header, png);
  AppendChunk("IDAT", packed, png);
  AppendChunk("IEND", "", png);
  return png;
}

}  // namespace mocurate
