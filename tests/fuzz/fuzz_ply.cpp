#include <cstddef>
#include <cstdint>

#include "core/formats/point_cloud.h"
#include "tests/support/cloud_writers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto ply = mocurate::ParsePly(bytes, "fuzz");
  if (!ply) return 0;
  (void)mocurate::PlyPoints(*ply, "fuzz");
  (void)mocurate::PlyTriangles(*ply, "fuzz");
  const auto back = mocurate::ParsePly(mocurate::WritePly(*ply), "again");
  if (!back || !(*back == *ply)) __builtin_trap();
  return 0;
}
