#include <cstddef>
#include <cstdint>

#include "core/formats/mdm_results.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto results = mocurate::MdmResults::Open({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!results) return 0;
  for (std::size_t n = 0; n < results->size() && n < 4; ++n) {
    const auto motion = results->Motion(n);
    if (motion && motion->values.size() != motion->shape[0] * results->joints() * 3) __builtin_trap();
  }
  return 0;
}
