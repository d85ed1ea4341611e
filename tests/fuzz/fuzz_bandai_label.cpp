#include <cstddef>
#include <cstdint>

#include "core/formats/bandai_label.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  (void)mocurate::ParseBandaiLabel(bytes, "fuzz");
  return 0;
}
