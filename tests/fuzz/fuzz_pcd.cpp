#include <cstddef>
#include <cstdint>

#include "core/formats/point_cloud.h"
#include "tests/support/cloud_writers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto pcd = mocurate::ParsePcd(bytes, "fuzz");
  if (!pcd) return 0;
  (void)mocurate::PcdPoints(*pcd, "fuzz");
  const auto back = mocurate::ParsePcd(mocurate::WritePcd(*pcd), "again");
  if (!back || !(*back == *pcd)) __builtin_trap();
  return 0;
}
