#pragma once

#include <string>
#include <vector>

#include "canon/options.h"
#include "core/base/finding.h"
#include "core/motion/clip.h"

namespace mocurate {

/// A sample [previous action, transition, action] of a long sequence, the training data of MultiAct (multiact.md A.3).
/// Frames of the sample are every `step`-th of the recording, starting at `first_frame`: previous action, transition,
/// action.
struct ActionTriple {
  std::string previous, current;  ///< labels
  int first_frame = 0;
  int step = 1;
  int previous_frames = 0;
  int transition_frames = 0;
  int current_frames = 0;

  int frames() const { return previous_frames + transition_frames + current_frames; }
  /// One past the last recorded frame of the sample.
  int end_frame() const { return first_frame + (frames() - 1) * step + 1; }
};

/// Samples of a sequence of `frames` frames with labelled segments, ordered by their begin. Two adjacent segments
/// without a transition give one sample, whose transition is cut out of both. Two segments adjacent to a transition
/// between them give one too; the transition is extended into both. Samples that are too short or too long are findings
/// (severity info: "triple_too_short", "triple_too_long", value: frames of the sample). Overlapping segments give no
/// pair. Times are truncated to frames, as in the released code.
std::vector<ActionTriple> FindTriples(const TripleOptions& options, const std::vector<Segment>& segments,
                                      FrameRate rate, int frames, std::vector<Finding>& findings);

/// The sample as a clip of its own: its frames, the label of the action, three segments of origin "triple" (the name
/// "transition" is set by the options). Error of Cut.
Expected<Clip> TakeTriple(const TripleOptions& options, const ActionTriple& triple, const Clip& clip);

}  // namespace mocurate
