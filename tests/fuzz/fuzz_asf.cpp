#include <cstddef>
#include <cstdint>

#include "core/formats/asf.h"
#include "tests/support/acclaim_writers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto asf = mocurate::ParseAsf(bytes, "fuzz");
  if (!asf) return 0;
  const std::string text = mocurate::WriteAsf(*asf);
  const auto again = mocurate::ParseAsf(text, "again");
  if (!again || mocurate::WriteAsf(*again) != text) __builtin_trap();
  return 0;
}
