// libFuzzer entry: clang++ -g -O1 -std=c++17 -fsanitize=fuzzer,address,undefined -I. tests/fuzz/fuzz_toml.cpp
// core/formats/*.cpp core/geometry/*.cpp core/base/{error,text,path_text}.cpp -I/usr/include/eigen3
#include <cstddef>
#include <cstdint>

#include "core/formats/toml.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  (void)mocurate::ParseToml(bytes, "fuzz");
  return 0;
}
