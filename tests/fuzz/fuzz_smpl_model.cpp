#include <cstddef>
#include <cstdint>

#include "core/formats/smpl_model.h"
#include "tests/support/smpl_model_writer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto model = mocurate::ParseSmplModel({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!model) return 0;
  const auto bytes = mocurate::EncodeSmplModelNpz(*model, "fuzz");
  if (!bytes || !mocurate::ParseSmplModel(*bytes, "again")) __builtin_trap();
  return 0;
}
