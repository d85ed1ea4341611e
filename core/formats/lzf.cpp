#include "core/formats/lzf.h"

namespace mocurate {
namespace {

constexpr std::size_t kLongestLiteral = 32;
constexpr std::size_t kLongestCopy = 264;  // 2 + 7 + 255
constexpr std::size_t kShortestCopy = 3;   // bytes of the block that it takes

}  // namespace

std::optional<std::string> UnpackLzf(std::string_view block, std::size_t size) {
  if (size / kLongestCopy > block.size() / kShortestCopy) return std::nullopt;
  std::string bytes;
  bytes.reserve(size);
  std::size_t at = 0;
  const auto next = [&](std::size_t& value) {
    if (at == block.size()) return false;
    value = static_cast<unsigned char>(block[at++]);
    return true;
  };
  for (std::size_t control = 0; next(control);) {
    if (control < kLongestLiteral) {
      const std::size_t length = control + 1;
      if (block.size() - at < length || size - bytes.size() < length) return std::nullopt;
      bytes.append(block.substr(at, length));
      at += length;
      continue;
    }
    std::size_t length = control >> 5;
    std::size_t extra = 0;
    if (length == 7 && !next(extra)) return std::nullopt;
    length += extra + 2;
    std::size_t low = 0;
    if (!next(low)) return std::nullopt;
    const std::size_t back = ((control & 0x1F) << 8) + low + 1;
    if (back > bytes.size() || size - bytes.size() < length) return std::nullopt;
    for (std::size_t i = 0; i < length; ++i) bytes += bytes[bytes.size() - back];
  }
  if (bytes.size() != size) return std::nullopt;
  return bytes;
}

}  // namespace mocurate
