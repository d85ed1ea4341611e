#include <cstddef>
#include <cstdint>

#include "core/formats/uestc_info.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mocurate;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  (void)ParseUestcFrameCounts(bytes, "fuzz");
  (void)ParseUestcActions(bytes, "fuzz");
  const auto videos = ParseUestcNames(bytes, "fuzz");
  if (!videos) return 0;
  const auto again = ParseUestcNames(WriteUestcNames(*videos), "again");
  if (!again || !(*again == *videos)) __builtin_trap();
  return 0;
}
