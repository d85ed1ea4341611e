#include <cstddef>
#include <cstdint>

#include "core/formats/phspd_text.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mocurate;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  (void)ParsePhspdRecording(bytes);
  if (const auto shape = ParsePhspdShape(bytes, "fuzz")) {
    const auto again = ParsePhspdShape(WritePhspdShape(*shape), "again");
    if (!again || again->pose_rad != shape->pose_rad) __builtin_trap();
  }
  const auto pose = ParsePhspdPose(bytes, "fuzz");
  if (!pose) return 0;
  const auto again = ParsePhspdPose(WritePhspdPose(*pose), "again");
  if (!again || again->position_m != pose->position_m) __builtin_trap();
  return 0;
}
