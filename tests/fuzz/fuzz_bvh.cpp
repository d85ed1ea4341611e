/// Any bytes as a BVH file: the result is an error or a motion that round-trips through the writer.

#include <cstddef>
#include <cstdint>

#include "core/formats/bvh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)mocurate::ParseBvh({reinterpret_cast<const char*>(data), size}, "fuzz", mocurate::DamagedRows::kReport);
  const auto bvh = mocurate::ParseBvh({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!bvh) return 0;
  if (bvh->frames > 0) {
    std::vector<mocurate::Vector3d> positions;
    mocurate::BvhForward(*bvh, bvh->frames - 1, positions);
  }
  const auto again = mocurate::ParseBvh(mocurate::WriteBvh(*bvh), "again");
  if (!again || again->values != bvh->values) __builtin_trap();
  return 0;
}
