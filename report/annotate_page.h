#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "report/options.h"

namespace mocurate {

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
  int step = 1;  ///< frames from one pose of the motions to the next
  PackedSpeeds speeds;
  std::vector<AnnotatedSpan> spans;
  bool done = false;  ///< has spans of an earlier session
  std::string key;    ///< key in the browser's store: sixteen digits of its id, motion and spans
};

struct AnnotatePageInput {
  std::string dataset;  ///< its file
  std::vector<std::string> labels;
  std::vector<AnnotateCard> cards;
  nlohmann::json motions;                         ///< of each card, joints alone: index of a viewer
  std::vector<std::string> parts;                 ///< of the motions, in base64
  nlohmann::json rest = nlohmann::json::array();  ///< spans of an earlier session that no card shows; saved again
};

/// One self-contained page: a card per clip with a player and a timeline, on which spans are marked and labelled. They
/// are saved as the spans.csv that canon.trim reads (docs/review.md).
std::string MakeAnnotatePage(const AnnotatePageInput& input);

}  // namespace mocurate
