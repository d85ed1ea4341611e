/// Any bytes as a checkpoint.

#include "tests/fuzz/memory_file.h"
#include "train/checkpoint/checkpoint.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const mocurate::MemoryFile file(data, size);
  (void)mocurate::ReadCheckpoint(file.path());
  return 0;
}
