#include <cstddef>
#include <cstdint>

#include "core/formats/c3d.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mocurate;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto c3d = ParseC3d(bytes, "fuzz", DamagedRows::kReport);
  if (!c3d) return 0;
  if (c3d->residual.size() * 8 > size) __builtin_trap();  // four numbers of two bytes each
  const auto written = WriteC3d(*c3d, "fuzz");
  if (!written) return 0;
  const auto again = ParseC3d(*written, "again");
  if (!again || again->frames != c3d->frames || again->points.size() != c3d->points.size()) __builtin_trap();
  for (std::size_t i = 0; i < c3d->residual.size(); ++i) {
    if ((c3d->residual[i] < 0.0F) != (again->residual[i] < 0.0F)) __builtin_trap();
  }
  return 0;
}
