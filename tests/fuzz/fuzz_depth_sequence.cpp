/// Any bytes as the JSON of a depth sequence.

#include <cstddef>
#include <cstdint>

#include "core/formats/depth_sequence.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)mocurate::ParseDepthSequence({reinterpret_cast<const char*>(data), size}, "fuzz");
  (void)mocurate::ParseDepthSequenceTruth({reinterpret_cast<const char*>(data), size}, "fuzz");
  return 0;
}
