/// Any bytes as a safetensors file; the result round-trips through the writer.

#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "core/formats/safetensors.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = mocurate::ParseSafetensors({reinterpret_cast<const char*>(data), size}, "input");
  if (!file) return 0;
  const std::string bytes = mocurate::EncodeSafetensors(*file);
  if (mocurate::EncodeSafetensors(*mocurate::ParseSafetensors(bytes, "again")) != bytes) std::abort();
  return 0;
}
