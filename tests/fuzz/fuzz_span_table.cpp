#include <cstddef>
#include <cstdint>

#include "core/formats/span_table.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)mocurate::ParseSpanTable(std::string_view(reinterpret_cast<const char*>(data), size), "fuzz");
  return 0;
}
