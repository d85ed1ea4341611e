#include <cstddef>
#include <cstdint>

#include "core/formats/vibe_pickle.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto tracks = mocurate::ParseVibeTracks(bytes, "fuzz");
  if (tracks) {
    const auto written = mocurate::EncodeVibeTracks(*tracks, "fuzz");
    if (!written || !mocurate::ParseVibeTracks(*written, "again")) __builtin_trap();
  }
  const auto cache = mocurate::VibeCache::Open(bytes, "fuzz");
  for (std::size_t i = 0; cache && i < cache->size(); ++i) (void)cache->Track(i);
  return 0;
}
