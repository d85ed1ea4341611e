#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/formats/joint_layout.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mocurate;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t end = std::min(bytes.find('\n'), bytes.size());
  const auto layout = ParseJointLayout(bytes.substr(0, end), "layout");
  if (!layout) return 0;
  JointTableLayout table;
  table.end_word = "END";
  (void)ParseJointRows(bytes.substr(end), *layout, table, "fuzz");
  table.damaged_rows = DamagedRows::kReport;
  (void)ParseJointRows(bytes.substr(end), *layout, table, "fuzz");
  return 0;
}
