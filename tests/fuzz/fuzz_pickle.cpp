#include <cstddef>
#include <cstdint>

#include "core/formats/pickle.h"

namespace {

/// Visits every value below a value, as a caller would.
void Visit(const mocurate::PickleRef& value) {
  (void)value.Array();
  (void)value.Sparse();
  (void)value.Text();
  (void)value.Number();
  const bool pairs = value.kind() == mocurate::PickleKind::kDict;
  for (std::size_t i = 0; i < value.size(); ++i) Visit(pairs ? value.ValueAt(i) : value.Item(i));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto pickle = mocurate::ParsePickle({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (pickle) Visit(pickle->top());
  return 0;
}
