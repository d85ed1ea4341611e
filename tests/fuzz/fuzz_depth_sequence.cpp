// libFuzzer entry: clang++ -g -O1 -std=c++17 -fsanitize=fuzzer,address,undefined -I. tests/fuzz/fuzz_depth_sequence.cpp
// core/formats/*.cpp core/geometry/*.cpp core/base/{error,text,path_text}.cpp -I/usr/include/eigen3
#include <cstddef>
#include <cstdint>

#include "core/formats/depth_sequence.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)mocurate::ParseDepthSequence({reinterpret_cast<const char*>(data), size}, "fuzz");
  (void)mocurate::ParseDepthSequenceTruth({reinterpret_cast<const char*>(data), size}, "fuzz");
  return 0;
}
