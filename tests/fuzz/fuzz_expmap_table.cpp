#include <cstddef>
#include <cstdint>

#include "core/formats/expmap_table.h"
#include "tests/support/expmap_writer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mocurate;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  (void)ParseExpmapTable(bytes, "fuzz", 0, DamagedRows::kReport);
  const auto table = ParseExpmapTable(bytes, "fuzz");
  if (!table) return 0;
  const auto again = ParseExpmapTable(WriteExpmapTable(*table), "again");
  if (!again || again->rotation_rad != table->rotation_rad) __builtin_trap();
  return 0;
}
