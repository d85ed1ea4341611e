// libFuzzer entry: clang++ -g -O1 -std=c++17 -fsanitize=fuzzer,address,undefined -I. tests/fuzz/fuzz_torch_pickle.cpp
// core/formats/*.cpp core/geometry/*.cpp core/base/{error,file,path_text,text}.cpp -I/usr/include/eigen3 -lzip
#include <cstddef>
#include <cstdint>

#include "core/formats/torch_pickle.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mocurate::TorchLimits limits;
  limits.elements = std::int64_t{1} << 24;
  (void)mocurate::ParseTorchPickle({reinterpret_cast<const char*>(data), size}, "fuzz", limits);
  return 0;
}
