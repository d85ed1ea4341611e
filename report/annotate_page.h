#pragma once

#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "core/pipeline/stage.h"
#include "report/filmstrip.h"
#include "report/options.h"
#include "report/packed_frames.h"

namespace mocurate {

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

/// Inputs: roles "dataset" and, if there is an earlier session, "spans" (its table, core/formats/span_table.h)
/// -> the page. Spans of the session replace the segments of the recordings that they name. Clips are read one at a
/// time; while all poses exceed options.poses_bytes, every second one is dropped. Errors: kUsage for an unknown clip,
/// kInconsistent when no clip is to be shown, or when no span is of a recording of the dataset; of ParseSpanTable.
Expected<StageOutcome> AnnotateStage(const StageRequest& request);

}  // namespace mocurate
