#pragma once

#include <string>
#include <vector>

#include "canon/options.h"
#include "core/base/finding.h"
#include "core/motion/clip.h"

namespace mocurate {

/// A sample [previous action, transition, action] of a long sequence, as MultiAct learns from (multiact.md A.3). Frames
/// of the sample are every `step`-th of the recording, from `first_frame` on: first those of the previous action, then
/// of the transition, then of the action.
struct ActionTriple {
  std::string previous, current;  ///< labels
  int first_frame = 0;
  int step = 1;
  int previous_frames = 0;
  int transition_frames = 0;
  int current_frames = 0;

  int frames() const { return previous_frames + transition_frames + current_frames; }
  /// One past the last frame of the recording that the sample takes.
  int end_frame() const { return first_frame + (frames() - 1) * step + 1; }
};

/// Samples of a sequence of `frames` frames, whose segments are labelled, in the order of their begin. Two segments
/// that touch, neither of them a transition, give one: its transition is cut out of both. Two that touch a transition
/// between them give one too: the transition is lengthened into both. Those that are too short or too long are findings
/// (severity info: "triple_too_short", "triple_too_long", value: frames of the sample). Segments that overlap make no
/// pair. Times become frames as the released code has it: truncated.
std::vector<ActionTriple> FindTriples(const TripleOptions& options, const std::vector<Segment>& segments,
                                      FrameRate rate, int frames, std::vector<Finding>& findings);

/// The sample as a clip of its own: frames taken, label of the action, three segments of origin "triple" ("transition"
/// is that of the options). Error of Cut.
Expected<Clip> TakeTriple(const TripleOptions& options, const ActionTriple& triple, const Clip& clip);

}  // namespace mocurate
