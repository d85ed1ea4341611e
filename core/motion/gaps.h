#pragma once

#include <vector>

#include "core/motion/clip.h"

namespace mocurate {

inline constexpr double kMaxGap_s = 0.5;  ///< longest gap that is interpolated, unless a source declares another
inline constexpr const char* kDeclaredMaxGap = "max_gap_s";  ///< provenance of a clip whose source declares another

/// Half-open runs [begin, end) of frames.
struct FrameRun {
  int begin = 0;
  int end = 0;

  int frames() const { return end - begin; }
};

/// The runs in which `flags` are `value`, in order.
std::vector<FrameRun> RunsWhere(const std::vector<bool>& flags, bool value);

/// The longest gap, in seconds, that may be interpolated in this clip.
double MaxGapOf(const Clip& clip);

/// States of samples that were observed or not. `observed` (F): of one joint or of whole frames; `time_s` (F) rising;
/// `frame_s`: length of a frame. A run of samples that were not observed is kInterpolated where it lasts at most
/// `max_gap_s`, else kInferred; all are kInferred where none was observed.
std::vector<JointState> GapStates(const std::vector<bool>& observed, const std::vector<double>& time_s, double frame_s,
                                  double max_gap_s);

/// Times of a clip's frames (F) from any zero, seconds: of its motion, else of its evidence.
std::vector<double> FrameTimes(const Clip& clip);

/// (F) Whether a sensor or program observed any part of the person in a frame: a joint of its motion that is neither
/// interpolated nor inferred, a sample of a track, a keypoint, a depth image, a cloud.
std::vector<bool> ObservedFrames(const Clip& clip);

/// (F) Frames of which every joint is kInferred; none where the motion has no states.
std::vector<bool> InferredFrames(const Motion& motion);

/// Whether the motion has frames, and every one of them is inferred throughout.
bool IsAllInferred(const Motion& motion);

/// Frames that are inferred throughout become kInterpolated where their run lasts at most `max_gap_s`, as GapStates
/// decides it, and lies between other frames: for fits that judge each frame alone.
void MarkShortGaps(double max_gap_s, Motion& motion);

/// The longest run of frames that are not inferred, the first of equally long ones; empty (0, 0) where there is none.
FrameRun LongestRunWithoutInferred(const Motion& motion);

}  // namespace mocurate
