#pragma once

#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "report/filmstrip.h"
#include "report/options.h"

namespace mocurate {

/// Compact poses of a motion, for pages with many long clips. One row per pose: the root as three int16 (little-endian,
/// relative to the first frame), then each other joint as three int8 relative to the root; x, y, z in multiples of
/// `root_mm` and `joint_mm`. The error is at most half of these: about 4 mm for a body with joints up to 1 m away from
/// its root.
struct PackedFrames {
  int step = 1;           ///< frames from one row to the next
  double root_mm = 1.0;   ///< of one unit of the root
  double joint_mm = 1.0;  ///< and of the other joints
  std::string rows;       ///< (ceil(F / step), 6 + 3 (J - 1)) bytes

  static std::size_t RowBytes(int joints) { return 6 + 3 * static_cast<std::size_t>(joints - 1); }
  /// Every second row, with twice the step.
  void Halve(int joints);
};
PackedFrames PackFrames(const Motion& motion, int step);

/// Speed curve of a motion, for display below a timeline.
struct PackedSpeeds {
  double fastest = 0.0;  ///< m/s, top of the curve
  std::string values;    ///< a byte per stretch of time, 255 times the square root of speed over `fastest`
};

/// Speed of the fastest joint in each frame, m/s, (F): displacement over the 0.2 s around the frame (truncated at the
/// ends), at least from one neighbour to the other, to suppress jitter.
std::vector<double> FastestJointSpeeds(const Motion& motion);
/// The fastest frame of each of at most `most` equal stretches.
PackedSpeeds PackSpeeds(const std::vector<double>& speeds, std::size_t most);

/// A labelled span of a recording, in seconds from the recording's first frame.
struct AnnotatedSpan {
  double begin_s = 0.0;
  double end_s = 0.0;
  std::string label;       ///< or empty
  std::string fine_label;  ///< or empty
  bool proposed = false;   ///< by a program: needs confirmation
};

/// One clip on the annotation page.
struct AnnotateCard {
  std::string clip;       ///< id
  std::string recording;  ///< id without the span, as in spans.csv
  std::string person;
  std::string label;  ///< of the whole clip, or empty
  int frames = 0;
  double hz = 0.0;
  double begin_s = 0.0;  ///< of its first frame in the recording
  double recorded_hz = 0.0;
  Viewpoint view;
  PackedFrames poses;
  PackedSpeeds speeds;
  std::vector<AnnotatedSpan> spans;
  bool done = false;  ///< has spans of an earlier session
  std::string key;    ///< key in the browser's store: sixteen digits of its id, motion and spans
};

struct AnnotatePageInput {
  std::string dataset;  ///< its file
  std::vector<std::string> labels;
  SkeletonPtr skeleton;
  std::vector<AnnotateCard> cards;
  nlohmann::json rest = nlohmann::json::array();  ///< spans of an earlier session that no card shows; saved again
};

/// One self-contained page: a card per clip with a player and a timeline, on which spans are marked and labelled. They
/// are saved as the spans.csv that canon.trim reads (docs/review.md).
std::string MakeAnnotatePage(const AnnotatePageInput& input);

}  // namespace mocurate
