#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/formats/trc.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mocurate;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  (void)ParseTrc(bytes, "fuzz", DamagedRows::kReport);
  const auto trc = ParseTrc(bytes, "fuzz");
  if (!trc) return 0;
  const auto again = ParseTrc(WriteTrc(*trc), "again");
  if (!again || again->names != trc->names || again->values.size() != trc->values.size()) __builtin_trap();
  for (std::size_t i = 0; i < trc->values.size(); ++i) {
    const bool hole = std::isnan(trc->values[i]);
    if (hole != std::isnan(again->values[i]) || (!hole && trc->values[i] != again->values[i])) __builtin_trap();
  }
  return 0;
}
