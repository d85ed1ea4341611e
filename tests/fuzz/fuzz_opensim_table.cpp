#include <cstddef>
#include <cstdint>

#include "core/formats/opensim_table.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)mocurate::ParseOpenSimTable({reinterpret_cast<const char*>(data), size}, "fuzz");
  return 0;
}
