#include "core/formats/png.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "core/formats/binary_numbers.h"

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

std::uint32_t BigAt(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = (value << 8) | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

const Bytef* Data(std::string_view bytes) { return reinterpret_cast<const Bytef*>(bytes.data()); }

/// Bytes of the rows with their filters; 0: interlaced or of no known kind, and not to be told in advance.
std::uint64_t RowBytes(std::string_view header) {
  constexpr std::array<int, 7> kSamples = {1, 0, 3, 1, 2, 0, 4};
  const auto colour = static_cast<unsigned char>(header[9]);
  if (header[12] != 0 || colour >= kSamples.size()) return 0;
  const std::uint64_t bits = static_cast<std::uint64_t>(BigAt(header, 0)) * static_cast<unsigned char>(header[8]) *
                             static_cast<std::uint64_t>(kSamples[colour]);
  return BigAt(header, 4) * (1 + (bits + 7) / 8);
}

struct Unpacked {
  std::uint64_t bytes = 0, nonzero = 0;
};

/// How many bytes packed data hold; nothing where they are damaged or cut off. Nothing is kept.
std::optional<Unpacked> UnpackedBytes(std::string_view packed) {
  z_stream stream = {};
  if (inflateInit(&stream) != Z_OK) return std::nullopt;
  std::array<Bytef, 1 << 15> buffer;
  stream.next_in = const_cast<Bytef*>(Data(packed));
  stream.avail_in = static_cast<uInt>(packed.size());
  int state = Z_OK;
  Unpacked unpacked;
  while (state == Z_OK) {
    stream.next_out = buffer.data();
    stream.avail_out = static_cast<uInt>(buffer.size());
    state = inflate(&stream, Z_NO_FLUSH);
    unpacked.nonzero +=
        static_cast<std::uint64_t>(std::count_if(buffer.data(), stream.next_out, [](Bytef byte) { return byte != 0; }));
  }
  unpacked.bytes = stream.total_out;
  inflateEnd(&stream);
  if (state != Z_STREAM_END) return std::nullopt;
  return unpacked;
}

/// Of a whole image. `rows`: of its height.
struct Contents {
  Unpacked unpacked;
  std::uint64_t rows = 0;
};

Expected<Contents> ReadContents(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kSignature = 8, kAround = 12, kHeader = 13;
  const char* whole = "the image is damaged or cut off: copy it again";
  if (bytes.substr(0, kSignature) != std::string_view("\x89PNG\r\n\x1a\n", kSignature))
    return Fail(ErrorCode::kMalformed, "the file does not begin as a PNG does", name, whole);
  std::string_view header;
  std::string packed;
  for (std::size_t at = kSignature;;) {
    if (bytes.size() < at + kAround)
      return Fail(ErrorCode::kMalformed, "the file ends before the end mark", name + ":IEND", whole);
    const std::uint64_t length = BigAt(bytes, at);
    const std::string type(bytes.substr(at + 4, 4));
    const std::string where = name + ":" + ShownText(type);
    if (length > bytes.size() - at - kAround)
      return Fail(ErrorCode::kMalformed, "the chunk announces more bytes than the file holds", where, whole);
    const std::string_view body = bytes.substr(at + 4, 4 + static_cast<std::size_t>(length));
    at += kAround + static_cast<std::size_t>(length);
    if (crc32(0, Data(body), static_cast<uInt>(body.size())) != BigAt(bytes, at - 4))
      return Fail(ErrorCode::kMalformed, "the chunk does not agree with its checksum", where, whole);
    if (type == "IHDR") header = body.substr(4);
    if (type == "IDAT") packed.append(body.substr(4));
    if (type == "IEND") break;
  }
  if (header.size() != kHeader) return Fail(ErrorCode::kMalformed, "the header is missing", name + ":IHDR", whole);
  const std::optional<Unpacked> unpacked = UnpackedBytes(packed);
  if (!unpacked) return Fail(ErrorCode::kMalformed, "the pixels do not unpack", name + ":IDAT", whole);
  const std::uint64_t rows = RowBytes(header);
  if (rows == 0 || rows == unpacked->bytes) return Contents{*unpacked, BigAt(header, 4)};
  return Fail(
      ErrorCode::kMalformed,
      "the header asks for " + std::to_string(rows) + " bytes of pixels, there are " + std::to_string(unpacked->bytes),
      name + ":IDAT", whole);
}

}  // namespace

Status CheckPng(std::string_view bytes, const std::string& name) {
  const Expected<Contents> contents = ReadContents(bytes, name);
  return contents ? Status() : Status(Forward(contents));
}

bool IsBlankPng(std::string_view bytes) {
  const Expected<Contents> contents = ReadContents(bytes, "");
  return contents && contents->unpacked.nonzero <= contents->rows;  // each row begins with the number of its filter
}

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
