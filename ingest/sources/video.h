#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/base/error.h"
#include "ingest/inspect/video_facts.h"

namespace mocurate {

/// One frame, (height, width, 3), red green blue, 0 to 255.
struct ColourFrame {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// A video file, decoded by OpenCV. Frames are counted by decoding from 0, never by seeking, which in many containers
/// ends at a key frame. Going forward decodes the frames between; going back starts again.
class VideoReader {
 public:
  /// Errors kNotFound; kMalformed for a file that is not a video or has no rate or size.
  static Expected<VideoReader> Open(const std::filesystem::path& file);
  VideoReader(VideoReader&&) noexcept;
  VideoReader& operator=(VideoReader&&) noexcept;
  ~VideoReader();

  const VideoFacts& facts() const;
  /// Error kNotFound where the file ends before it; the message holds the number of frames.
  Expected<ColourFrame> Frame(int index);
  /// The frame shown at this time: rate * seconds, rounded down.
  Expected<ColourFrame> FrameAt(double seconds);

 private:
  struct Decoder;
  VideoReader();
  std::unique_ptr<Decoder> decoder_;
};

}  // namespace mocurate
