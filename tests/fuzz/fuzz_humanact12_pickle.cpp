// libFuzzer entry: clang++ -g -O1 -std=c++17 -fsanitize=fuzzer,address,undefined -I.
// tests/fuzz/fuzz_humanact12_pickle.cpp core/formats/*.cpp core/geometry/*.cpp
// core/base/{error,file,path_text,text}.cpp -I/usr/include/eigen3 -lzip
#include <cstddef>
#include <cstdint>

#include "core/formats/humanact12_pickle.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto clips = mocurate::ParseHumanAct12Pickle({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!clips) return 0;
  const auto bytes = mocurate::EncodeHumanAct12Pickle(*clips, "fuzz");
  if (!bytes || !mocurate::ParseHumanAct12Pickle(*bytes, "again")) __builtin_trap();
  return 0;
}
