#include <cstddef>
#include <cstdint>

#include "core/formats/humanact12_pickle.h"
#include "tests/support/humanact12_clips.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto clips = mocurate::ParseHumanAct12Pickle({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!clips) return 0;
  const auto bytes = mocurate::EncodeHumanAct12Pickle(*clips, "fuzz");
  if (!bytes || !mocurate::ParseHumanAct12Pickle(*bytes, "again")) __builtin_trap();
  return 0;
}
