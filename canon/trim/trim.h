#pragma once

#include <optional>
#include <string>
#include <vector>

#include "canon/options.h"
#include "core/base/finding.h"
#include "core/motion/clip.h"

namespace mocurate {

/// Frames [begin, end) of a clip that are kept, with their label.
struct KeptSpan {
  int begin = 0;
  int end = 0;
  std::string label;
  std::string fine_label;
  double confidence = 1.0;  ///< in [0, 1], the smaller one of both ends, where a rule estimates them (EstimatesCuts)
};

/// Whether a rule estimates cuts: change_points, cycles, by_example.
bool EstimatesCuts(TrimRule rule);

/// Error kInconsistent at `where` for more than 100 segments in one frame: the clips that are cut would repeat it as
/// often, each with all of them.
Status CheckOverlap(const Clip& clip, const std::string& where);

/// A finding about frames of a clip that are dropped.
Finding DroppedSpan(const Clip& clip, const char* code, int begin, int end, double value, std::string message,
                    Severity severity = Severity::kWarning);

/// Window of FrameSpeeds: longer ones suppress more noise.
inline constexpr double kSpeedWindow_s = 0.4;

/// Speed of the fastest joint in each frame, m/s, (F): the slope of a line fitted to the joint over the `window_s`
/// seconds around the frame, at least its two neighbours. At the ends the window is shifted inwards, so that its length
/// is constant. White noise of s metres at F frames in the window changes the slope by about 3.5 s / (window_s
/// sqrt(F)).
std::vector<double> FrameSpeeds(const Motion& motion, double window_s);

/// A piece of a recording between two change points, frames [begin, end).
struct ProposedSegment {
  int begin = 0;
  int end = 0;
  bool rest = false;        ///< still, in the recording's most frequent still posture
  double confidence = 1.0;  ///< probability that `begin` is a boundary; 1 for the first segment
};

/// Cuts a recording where the action changes, into the pieces that minimise
///
///   sum over the segments of  sum_t |phi(x_t) - mean|^2 / rate  +  sum over the boundaries of  penalty(t)
///
/// by dynamic programming (kernel change-point detection: Harchaoui and Cappe 2007, Arlot et al. 2019). phi is the
/// feature map of a Gaussian kernel over the descriptions x_t at 25 Hz: the body's pose, the speed of each joint, and
/// the distance from rest. The penalty is small at rest, where actions begin and end, and larger within a movement.
/// Rest is stillness in the posture that most separate still moments share; a recording without such moments has a
/// constant penalty. A rest shorter than `least_rest_s` becomes one boundary in its middle.
///
/// Segments in order, from the first frame to the last; empty for a motion without frames. Boundaries below
/// `min_confidence` are dropped. Time is linear in the length: about 0.15 s for a minute at 120 Hz.
std::vector<ProposedSegment> ProposeSegments(const ChangePointOptions& options, const Motion& motion);

/// Cuts a recording of one exercise into its repetitions.
///
/// The moving part of the recording is compared with itself: d(lag) is the mean squared distance of the body's poses
/// and velocities at times `lag` apart, over the half of the times that agree best. A period is a lag where d falls to
/// at most half of the largest d of shorter lags (after Cutler and Davis 2000). Of several, the shortest that is nearly
/// as good as the best is used, so that two repetitions do not count as one. Dynamic programming then places boundaries
/// from the begin of the moving part to its end: repetitions about as long as the period, and similar to their
/// neighbours.
///
/// Repetitions in order, from the first moving frame to the last one; a single one for a motion that is not periodic
/// (confidence: the smallest ratio of d to the largest of shorter lags), none for one that never moves. Without labels;
/// the confidence is the similarity to the adjacent repetitions.
std::vector<KeptSpan> FindCycles(const CycleOptions& options, const Motion& motion);

/// Spans to keep, in order. Every span that is dropped, and every cut of more than a frame, is a finding with its rule
/// and value. May be empty.
std::vector<KeptSpan> FindSpans(const TrimOptions& options, const Clip& clip, std::vector<Finding>& findings);

/// The spans of at least options.min_length_s; the others are findings ("too_short").
std::vector<KeptSpan> LongEnough(const TrimOptions& options, const Clip& clip, const std::vector<KeptSpan>& spans,
                                 std::vector<Finding>& findings);

/// Threshold for the value of a dropped span: "too_short" in seconds, "never_moves" in m/s; nothing for other rules.
std::optional<double> LimitOfTrim(const TrimOptions& options, const std::string& rule);

}  // namespace mocurate
