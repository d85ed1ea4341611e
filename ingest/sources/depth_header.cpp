#include "ingest/sources/depth_header.h"

#include <algorithm>

#include "core/base/file.h"
#include "core/formats/png.h"

namespace mocurate {
Status SetImageSize(const StageInput& input, Camera& camera) {
  std::string head;
  const Status read = ReadFileInParts(input.path, [&](std::string_view part) {
    head.append(part.substr(0, kPngHeaderBytes - std::min(kPngHeaderBytes, head.size())));
  });
  if (!read) return read;
  const Expected<PngHeader> header = ReadPngHeader(head, input.name);
  if (!header) return Forward(header);
  if (header->bits != 16 || header->channels != 1) {
    return Fail(ErrorCode::kMalformed,
                std::to_string(header->channels) + " channels of " + std::to_string(header->bits) + " bits", input.name,
                "depth images are 16-bit grey PNG");
  }
  camera.width = header->width;
  camera.height = header->height;
  return {};
}

}  // namespace mocurate
