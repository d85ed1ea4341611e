#include "core/formats/png.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>

#include "core/base/file.h"
#include "core/formats/line_reader.h"

namespace mocurate {
namespace {

constexpr png_uint_32 kMostDecoded = 16384, kMostChecked = 1'000'000;  // pixels along a side
constexpr int kCompression = 3;                                        // of 9: depth images gain little beyond

/// libpng reports an error by a jump to the last setjmp, past destructors. So every call of libpng is in a member
/// function that sets the jump and has no objects of its own.
class PngReader {
 public:
  explicit PngReader(std::string_view bytes)
      : next_(reinterpret_cast<png_const_bytep>(bytes.data())),
        left_(bytes.size()),
        bytes_(bytes.size()),
        png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, this, OnError, OnWarning)),
        info_(png_ == nullptr ? nullptr : png_create_info_struct(png_)) {}
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }

  /// The header alone: bytes are pushed, so libpng does not miss those behind it. False: see Failure.
  bool ReadHeader() {
    if (info_ == nullptr || setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_progressive_read_fn(png_, nullptr, nullptr, nullptr, nullptr);
    png_process_data(png_, info_, const_cast<png_bytep>(next_), std::min(left_, kPngHeaderBytes));
    if (png_get_image_width(png_, info_) == 0) png_error(png_, "the file ends within its header");
    return true;
  }

  /// The chunks before the pixels. `most`: pixels along a side.
  bool Begin(png_uint_32 most) {
    if (info_ == nullptr || setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_read_fn(png_, this, OnRead);
    png_set_user_limits(png_, most, most);
    png_set_crc_action(png_, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_set_benign_errors(png_, 0);
    png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);  // colour profiles, texts, times
    png_read_info(png_, info_);
    png_set_expand(png_);
    png_set_swap(png_);
    passes_ = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return true;
  }

  bool ReadRow(std::uint8_t* row) {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    in_rows_ = true;
    png_read_row(png_, row, nullptr);
    return true;
  }

  bool End() {
    if (setjmp(png_jmpbuf(png_)) != 0) return false;
    in_rows_ = false;
    png_read_end(png_, nullptr);
    return true;
  }

  int passes() const { return passes_; }
  std::size_t row_bytes() const { return png_get_rowbytes(png_, info_); }
  std::size_t file_bytes() const { return bytes_; }
  PngHeader header() const {
    return {static_cast<int>(png_get_image_width(png_, info_)), static_cast<int>(png_get_image_height(png_, info_)),
            png_get_bit_depth(png_, info_), png_get_channels(png_, info_)};
  }

  tl::unexpected<Error> Failure(const std::string& name) const {
    return Fail(ErrorCode::kMalformed, std::string("the image is damaged or cut off (libpng: ") + message_.data() + ")",
                name + Chunk(), "copy it again");
  }

 private:
  static PngReader* Of(void* reader) { return static_cast<PngReader*>(reader); }
  [[noreturn]] static void OnError(png_structp png, png_const_charp message) {
    std::snprintf(Of(png_get_error_ptr(png))->message_.data(), sizeof message_, "%s", message);
    png_longjmp(png, 1);
  }
  static void OnWarning(png_structp, png_const_charp) {}
  static void OnRead(png_structp png, png_bytep out, std::size_t count) {
    PngReader* const reader = Of(png_get_io_ptr(png));
    reader->is_cut_ = count > reader->left_;
    if (reader->is_cut_) png_error(png, "the file ends too early");
    std::memcpy(out, reader->next_, count);
    reader->next_ += count;
    reader->left_ -= count;
  }

  /// ":IDAT"; empty where the file is not a PNG.
  std::string Chunk() const {
    const bool no_chunk = is_cut_ && (png_get_io_state(png_) & PNG_IO_MASK_LOC) == PNG_IO_CHUNK_HDR;
    if (no_chunk) return ":IEND";
    if (in_rows_) return ":IDAT";
    const png_uint_32 type = png_ == nullptr ? 0 : png_get_io_chunk_type(png_);
    if (type == 0) return "";
    std::string text;
    for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>((type >> shift) & 0xFF);
    return ":" + Shown(text);
  }

  png_const_bytep next_;
  std::size_t left_, bytes_;
  bool is_cut_ = false, in_rows_ = false;
  int passes_ = 1;
  std::array<char, 128> message_ = {"no memory"};
  png_structp png_;
  png_infop info_;
};

/// All rows into `rows`, or each over the one before if `keep` is false.
Status ReadRows(PngReader& reader, const std::string& name, bool keep, std::vector<std::uint8_t>& rows) {
  const std::size_t size = reader.row_bytes();
  const auto height = static_cast<std::size_t>(reader.header().height);
  const std::uint64_t most = MostUnpacked(reader.file_bytes());
  if (height > most / size) {
    return Fail(ErrorCode::kMalformed,
                "an image of " + std::to_string(reader.header().width) + " x " + std::to_string(height) +
                    " pixels unpacks to " + std::to_string(height * size) + " bytes; a file of " +
                    std::to_string(reader.file_bytes()) + " bytes may hold " + std::to_string(most),
                name + ":IHDR", "make the image smaller");
  }
  rows.resize(keep ? size * height : size);
  for (int pass = 0; pass < reader.passes(); ++pass) {
    for (std::size_t y = 0; y < height; ++y) {
      if (!reader.ReadRow(rows.data() + (keep ? y * size : 0))) return reader.Failure(name);
    }
  }
  return reader.End() ? Status() : reader.Failure(name);
}

/// Writes to a string; jumps as in PngReader.
class PngWriter {
 public:
  PngWriter() : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, OnError, OnWarning)) {
    if (png_ != nullptr) info_ = png_create_info_struct(png_);
  }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png_, &info_); }

  bool Write(const DepthImage& image, std::string& bytes) {
    if (info_ == nullptr || setjmp(png_jmpbuf(png_)) != 0) return false;
    png_set_write_fn(png_, &bytes, OnWrite, nullptr);
    png_set_IHDR(png_, info_, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height), 16,
                 PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_filter(png_, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
    png_set_compression_level(png_, kCompression);
    png_set_compression_strategy(png_, 0);  // zlib's default
    png_write_info(png_, info_);
    png_set_swap(png_);
    for (int y = 0; y < image.height; ++y) {
      const std::uint16_t* const row = image.values.data() + static_cast<std::ptrdiff_t>(y) * image.width;
      png_write_row(png_, reinterpret_cast<png_const_bytep>(row));
    }
    png_write_end(png_, nullptr);
    return true;
  }

 private:
  [[noreturn]] static void OnError(png_structp png, png_const_charp) { png_longjmp(png, 1); }
  static void OnWarning(png_structp, png_const_charp) {}
  static void OnWrite(png_structp png, png_bytep data, std::size_t count) {
    static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(data), count);
  }

  png_structp png_;
  png_infop info_ = nullptr;
};

}  // namespace

Expected<PngHeader> ReadPngHeader(std::string_view bytes, const std::string& name) {
  PngReader reader(bytes);
  if (!reader.ReadHeader()) return reader.Failure(name);
  return reader.header();
}

Expected<PngImage> DecodePng(std::string_view bytes, const std::string& name) {
  PngReader reader(bytes);
  if (!reader.Begin(kMostDecoded)) return reader.Failure(name);
  PngImage image{reader.header(), {}};
  if (Status read = ReadRows(reader, name, true, image.bytes); !read) return Forward(read);
  return image;
}

Expected<DepthImage> DecodeDepthPng(std::string_view bytes, const std::string& name) {
  const Expected<PngImage> image = DecodePng(bytes, name);
  if (!image) return Forward(image);
  const PngHeader& header = image->header;
  if (header.channels != 1 || header.bits != 16) {
    return Fail(ErrorCode::kMalformed,
                std::to_string(header.channels) + " channels of " + std::to_string(header.bits) +
                    " bits, a depth image has one of 16",
                name);
  }
  DepthImage depth{header.width, header.height, std::vector<std::uint16_t>(image->bytes.size() / 2)};
  std::memcpy(depth.values.data(), image->bytes.data(), image->bytes.size());
  return depth;
}

Status CheckPng(std::string_view bytes, const std::string& name) {
  PngReader reader(bytes);
  if (!reader.Begin(kMostChecked)) return reader.Failure(name);
  std::vector<std::uint8_t> row;
  return ReadRows(reader, name, false, row);
}

Expected<std::string> EncodePng(const DepthImage& image) {
  const bool is_whole = image.width > 0 && image.height > 0 &&
                        image.values.size() == static_cast<std::size_t>(image.width) * image.height;
  if (!is_whole) {
    return Fail(ErrorCode::kInconsistent, std::to_string(image.values.size()) + " values do not fill an image of " +
                                              std::to_string(image.width) + " x " + std::to_string(image.height));
  }
  std::string bytes;
  if (!PngWriter().Write(image, bytes)) return Fail(ErrorCode::kInternal, "libpng wrote no image");
  return bytes;
}

}  // namespace mocurate
