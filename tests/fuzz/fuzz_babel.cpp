#include <cstddef>
#include <cstdint>

#include "core/formats/babel.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto babel = mocurate::ParseBabel({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!babel) return 0;
  for (const mocurate::BabelSequence& sequence : *babel) (void)mocurate::FindBabelProblems(sequence);
  if (!mocurate::ParseBabel(mocurate::EncodeBabel(*babel), "again")) __builtin_trap();
  return 0;
}
