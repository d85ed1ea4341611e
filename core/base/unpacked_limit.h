#pragma once

#include <cstdint>

namespace mocurate {

/// Bytes that what a file of `bytes` bytes holds may take in memory, whatever it packs, repeats or declares. A number
/// of one digit and a blank gives a double of 8 bytes, one of uint8 as well: what is not packed stays below 16.
constexpr std::uint64_t MostUnpacked(std::uint64_t bytes) { return (std::uint64_t{64} << 20) + 16 * bytes; }

}  // namespace mocurate
