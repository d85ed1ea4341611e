#pragma once

#include <array>
#include <cstdint>

namespace mocurate {

/// kept[i] = 1 with chance 1 - dropped/65536, else 0, from Philox 4x32-10 of (key, block): eight numbers a block, 16
/// blocks side by side.
void FillKept(const std::array<std::uint32_t, 2>& key, std::int64_t count, std::uint32_t dropped, std::uint8_t* kept);

/// result[i] = kept[i] ? value[i] * scale : 0
void ApplyKept(const float* value, const std::uint8_t* kept, std::int64_t count, float scale, float* result);

}  // namespace mocurate
