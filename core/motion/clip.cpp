#include "core/motion/clip.h"

namespace mocurate {

std::string ClipIdentity::id() const {
  return source + "/" + person + "/" + recording + "#" + std::to_string(begin_frame) + "-" + std::to_string(end_frame);
}

void ResolveDepthFiles(const std::map<std::string, std::filesystem::path>& files, Evidence& evidence) {
  for (DepthView& view : evidence.depth_views) {
    for (auto* paths : {&view.files, &view.masks}) {
      for (std::filesystem::path& file : *paths) {
        const auto found = files.find(file.string());
        if (found != files.end()) file = found->second;
      }
    }
  }
}

FrameRate RecordedRate(const Clip& clip) {
  const auto noted = clip.provenance.find(kRecordedRate);
  if (noted != clip.provenance.end()) {
    if (const auto rate = FrameRate::Parse(noted->second)) return *rate;
  }
  return clip.motion ? clip.motion->rate : clip.rate;
}

}  // namespace mocurate
