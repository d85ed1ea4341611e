/// First line: a file-name pattern; rest: a name. A match must match again after its fields are filled in.

#include <cstddef>
#include <cstdint>
#include <string>

#include "ingest/sources/pattern.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t end = std::min(bytes.find('\n'), bytes.size());
  const auto pattern = mocurate::NamePattern::Parse(bytes.substr(0, end), "fuzz");
  if (!pattern) return pattern.error().Message().empty() ? __builtin_trap(), 0 : 0;
  const std::string name = end < bytes.size() ? bytes.substr(end + 1) : std::string();
  const auto fields = pattern->Match(name);
  if (!fields) return 0;
  for (const std::string& field : pattern->FieldNames()) {
    if (fields->count(field) == 0) __builtin_trap();
  }
  for (const auto& [field, value] : *fields) {
    if (value.empty() || value.find('/') != std::string::npos) __builtin_trap();
  }
  return 0;
}
