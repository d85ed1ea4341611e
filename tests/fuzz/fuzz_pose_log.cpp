#include <cstddef>
#include <cstdint>

#include "core/formats/pose_log.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto poses = mocurate::ParsePoseLog(bytes, "fuzz");
  if (!poses) return 0;
  const auto back = mocurate::ParsePoseLog(mocurate::WritePoseLog(*poses), "again");
  if (!back || back->size() != poses->size()) __builtin_trap();
  return 0;
}
