/// Any bytes as an .npy file: the result is an error or an array no larger than the file that round-trips through the
/// writer.

#include <cstddef>
#include <cstdint>

#include "core/formats/npy.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto array = mocurate::ParseNpy({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!array) return 0;
  if (array->values.size() > size) __builtin_trap();
  const auto bytes = mocurate::EncodeNpy(*array, "fuzz");
  if (!bytes || !mocurate::ParseNpy(*bytes, "again")) __builtin_trap();
  return 0;
}
