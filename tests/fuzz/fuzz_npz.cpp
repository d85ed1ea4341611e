#include <cstddef>
#include <cstdint>

#include "core/formats/npz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto npz = mocurate::ParseNpz({reinterpret_cast<const char*>(data), size}, "fuzz");
  if (!npz) return 0;
  mocurate::Npz plain;
  for (const mocurate::NpzMember& member : npz->members) {
    if (member.skipped.empty()) plain.members.push_back(member);
  }
  const auto bytes = mocurate::EncodeNpz(plain, "fuzz");
  if (!bytes || !mocurate::ParseNpz(*bytes, "again")) __builtin_trap();
  return 0;
}
