// libFuzzer entry: clang++ -g -O1 -std=c++17 -fsanitize=fuzzer,address,undefined -I. tests/fuzz/fuzz_npy.cpp
// core/formats/*.cpp core/geometry/*.cpp core/base/{error,file,path_text,text}.cpp -I/usr/include/eigen3 -lzip
#include <cstddef>
#include <cstdint>

#include "core/formats/npy.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto array = mocurate::ParseNpy({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!array) return 0;
  const auto bytes = mocurate::EncodeNpy(*array, "fuzz");
  if (!bytes || !mocurate::ParseNpy(*bytes, "again")) __builtin_trap();
  return 0;
}
