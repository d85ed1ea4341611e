#include <cstddef>
#include <cstdint>

#include "core/formats/obj.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto obj = mocurate::ParseObj(bytes, "fuzz");
  if (!obj) return 0;
  (void)mocurate::ObjTriangles(*obj);
  const auto back = mocurate::ParseObj(mocurate::WriteObj(*obj), "again");
  if (!back || !(*back == *obj)) __builtin_trap();
  return 0;
}
