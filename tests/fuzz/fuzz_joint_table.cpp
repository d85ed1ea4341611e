// libFuzzer entry: clang++ -g -O1 -std=c++17 -fsanitize=fuzzer,address,undefined -I. tests/fuzz/fuzz_joint_table.cpp
// core/formats/*.cpp core/geometry/*.cpp core/base/{error,text,path_text}.cpp -I/usr/include/eigen3
#include <cstddef>
#include <cstdint>

#include "core/formats/joint_table.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mocurate::JointTableLayout layout;
  layout.rows_per_frame = 3;
  (void)mocurate::ParseJointTable({reinterpret_cast<const char*>(data), size}, layout, "fuzz");
  return 0;
}
