#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace mocurate {

/// LZF blocks (Marc Lehmann's liblzf, as PCD files hold them). Empty when the block is damaged or does not give exactly
/// `size` bytes; nothing beyond what the block could give is allocated.
std::optional<std::string> UnpackLzf(std::string_view block, std::size_t size);

}  // namespace mocurate
