#include "train/layers/keep_mask.h"

#include <algorithm>

#include "train/recognisers/vector_clones.h"

namespace mocurate {
namespace {

constexpr int kLanes = 16;          // blocks at once
constexpr int kChunk = 8 * kLanes;  // numbers of as many blocks
constexpr std::uint64_t kM0 = 0xD2511F53u,
                        kM1 = 0xCD9E8D57u;  // multipliers and key steps of Philox (Salmon et al. 2011)
constexpr std::uint32_t kW0 = 0x9E3779B9u, kW1 = 0xBB67AE85u;

}  // namespace

MOCURATE_VECTOR_CLONES
void FillKept(const std::array<std::uint32_t, 2>& key, std::int64_t count, std::uint32_t dropped, std::uint8_t* kept) {
  for (std::int64_t begin = 0; begin < count; begin += kChunk) {
    std::uint32_t c0[kLanes], c1[kLanes], c2[kLanes], c3[kLanes];
    for (int i = 0; i < kLanes; ++i) {
      const auto block = static_cast<std::uint64_t>(begin / 8 + i);
      c0[i] = static_cast<std::uint32_t>(block);
      c1[i] = static_cast<std::uint32_t>(block >> 32);
      c2[i] = 0;
      c3[i] = 0;
    }
    std::uint32_t k0 = key[0], k1 = key[1];
    for (int round = 0; round < 10; ++round, k0 += kW0, k1 += kW1) {
      for (int i = 0; i < kLanes; ++i) {
        const std::uint64_t p0 = kM0 * c0[i], p1 = kM1 * c2[i];
        const std::uint32_t n0 = static_cast<std::uint32_t>(p1 >> 32) ^ c1[i] ^ k0;
        const std::uint32_t n2 = static_cast<std::uint32_t>(p0 >> 32) ^ c3[i] ^ k1;
        c1[i] = static_cast<std::uint32_t>(p1);
        c3[i] = static_cast<std::uint32_t>(p0);
        c0[i] = n0;
        c2[i] = n2;
      }
    }
    std::uint8_t of_chunk[kChunk];
    for (int i = 0; i < kLanes; ++i) {
      of_chunk[i] = (c0[i] & 0xffffu) >= dropped;
      of_chunk[kLanes + i] = (c0[i] >> 16) >= dropped;
      of_chunk[2 * kLanes + i] = (c1[i] & 0xffffu) >= dropped;
      of_chunk[3 * kLanes + i] = (c1[i] >> 16) >= dropped;
      of_chunk[4 * kLanes + i] = (c2[i] & 0xffffu) >= dropped;
      of_chunk[5 * kLanes + i] = (c2[i] >> 16) >= dropped;
      of_chunk[6 * kLanes + i] = (c3[i] & 0xffffu) >= dropped;
      of_chunk[7 * kLanes + i] = (c3[i] >> 16) >= dropped;
    }
    std::copy_n(of_chunk, std::min<std::int64_t>(kChunk, count - begin), kept + begin);
  }
}

MOCURATE_VECTOR_CLONES
void ApplyKept(const float* value, const std::uint8_t* kept, std::int64_t count, float scale, float* result) {
  for (std::int64_t i = 0; i < count; ++i) result[i] = kept[i] != 0 ? value[i] * scale : 0.0f;
}

}  // namespace mocurate
