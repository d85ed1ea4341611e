#include <cstddef>
#include <cstdint>

#include "core/formats/ntu_skeleton.h"
#include "tests/support/ntu_equal.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  (void)mocurate::ParseNtuSkeleton(bytes, "fuzz", mocurate::DamagedRows::kReport);
  const auto skeleton = mocurate::ParseNtuSkeleton(bytes, "fuzz");
  if (!skeleton) return 0;
  const auto again = mocurate::ParseNtuSkeleton(mocurate::WriteNtuSkeleton(*skeleton), "again");
  if (!again || !(*again == *skeleton)) __builtin_trap();
  return 0;
}
