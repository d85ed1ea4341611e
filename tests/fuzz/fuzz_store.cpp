/// Any bytes as any file of the store.

#include <nlohmann/json.hpp>

#include "core/store/store.h"
#include "tests/fuzz/memory_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const mocurate::MemoryFile file(data, size);
  (void)mocurate::ReadDataset(file.path());
  (void)mocurate::ReadEvidence(file.path());
  (void)mocurate::ReadTruth(file.path());
  (void)mocurate::DescribeStore(file.path());
  return 0;
}
