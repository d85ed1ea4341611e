/// Any bytes as a joint table of three rows per frame: the result is an error or finite numbers.

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/formats/joint_table.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mocurate::JointTableLayout layout;
  layout.rows_per_frame = 3;
  const auto table = mocurate::ParseJointTable({reinterpret_cast<const char*>(data), size}, layout, "fuzz");
  if (!table) return 0;
  for (const double value : table->values) {
    if (!std::isfinite(value)) __builtin_trap();
  }
  return 0;
}
