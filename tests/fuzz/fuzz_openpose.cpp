#include <cstddef>
#include <cstdint>

#include "core/formats/openpose.h"
#include "core/formats/panoptic_bodies.h"
#include "tests/support/keypoints_equal.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  (void)mocurate::ParsePanopticBodies(bytes, "fuzz");
  const auto frame = mocurate::ParseOpenPose(bytes, "fuzz");
  if (!frame) return 0;
  const auto back = mocurate::ParseOpenPose(mocurate::WriteOpenPose(*frame), "again");
  if (!back || !(back->people == frame->people)) __builtin_trap();
  return 0;
}
