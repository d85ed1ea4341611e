#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/base/error.h"
#include "ingest/sense/video_facts.h"

namespace mocurate {

/// One frame, (height, width, 3), red green blue, 0 to 255.
struct ColourFrame {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// A video file, decoded by OpenCV. Frames are counted from 0 by decoding, never by seeking, which in many containers
/// ends at a key frame: going forward costs what lies between, going back begins again.
class VideoReader {
 public:
  /// Errors kNotFound, kMalformed for what is no video or has no rate or size.
  static Expected<VideoReader> Open(const std::filesystem::path& file);
  VideoReader(VideoReader&&) noexcept;
  VideoReader& operator=(VideoReader&&) noexcept;
  ~VideoReader();

  const VideoFacts& facts() const;
  /// Error kNotFound where the file ends before it, which also tells how many frames there are.
  Expected<ColourFrame> Frame(int index);
  /// The frame that is shown at this time: rate * seconds, rounded down.
  Expected<ColourFrame> FrameAt(double seconds);

 private:
  struct Decoder;
  VideoReader();
  std::unique_ptr<Decoder> decoder_;
};

}  // namespace mocurate
