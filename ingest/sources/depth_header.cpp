#include "ingest/sources/depth_header.h"

#include <algorithm>

#include "core/base/file.h"

namespace mocurate {
namespace {

/// A number of 4 bytes, most significant first.
int HeaderNumber(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = 256 * value + static_cast<unsigned char>(bytes[at + i]);
  return static_cast<int>(value & 0x7fffffffu);
}

}  // namespace

Status SetImageSize(const StageInput& input, Camera& camera) {
  std::string head;
  const Status read = ReadFileInParts(input.path, [&](std::string_view part) {
    head.append(part.substr(0, 26 - std::min<std::size_t>(26, head.size())));
  });
  if (!read) return read;
  if (head.size() < 26 || head.rfind("\x89PNG\r\n\x1a\n", 0) != 0) {
    return Fail(ErrorCode::kMalformed, "the file is no PNG image", input.name, "depth images are 16-bit grey PNG");
  }
  if (head[24] != 16 || head[25] != 0) {
    return Fail(ErrorCode::kMalformed,
                std::to_string(static_cast<int>(head[24])) + " bits of colour type " +
                    std::to_string(static_cast<int>(head[25])),
                input.name, "depth images are 16-bit grey PNG (colour type 0)");
  }
  camera.width = HeaderNumber(head, 16);
  camera.height = HeaderNumber(head, 20);
  return {};
}

}  // namespace mocurate
