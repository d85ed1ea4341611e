/// Any bytes as a torch.save file: no code runs, and allocations stay within the limits.

#include <cstddef>
#include <cstdint>

#include "core/formats/torch_pickle.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mocurate::TorchLimits limits;
  limits.elements = 1 << 20;
  limits.objects = 1 << 16;
  limits.characters = 1 << 20;
  const auto table = mocurate::ParseTorchPickle({reinterpret_cast<const char*>(data), size}, "fuzz", limits);
  if (!table) return 0;
  std::int64_t elements = 0;
  for (const mocurate::TorchTensor& tensor : table->tensors)
    elements += static_cast<std::int64_t>(tensor.values.size());
  if (elements > limits.elements) __builtin_trap();
  return 0;
}
