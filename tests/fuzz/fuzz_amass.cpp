#include <cstddef>
#include <cstdint>

#include "core/formats/amass.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto amass = mocurate::ParseAmass({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!amass) return 0;
  const auto bytes = mocurate::EncodeAmass(*amass, "fuzz");
  if (!bytes || !mocurate::ParseAmass(*bytes, "again")) __builtin_trap();
  return 0;
}
