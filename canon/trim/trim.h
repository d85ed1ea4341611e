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

/// Spans to keep, in order. Every span that is dropped, and every cut of more than a frame, is a finding with its rule
/// and value. May be empty.
std::vector<KeptSpan> FindSpans(const TrimOptions& options, const Clip& clip, std::vector<Finding>& findings);

/// The spans of at least options.min_length_s; the others are findings ("too_short").
std::vector<KeptSpan> LongEnough(const TrimOptions& options, const Clip& clip, const std::vector<KeptSpan>& spans,
                                 std::vector<Finding>& findings);

/// Threshold for the value of a dropped span: "too_short" in seconds, "never_moves" in m/s; nothing for other rules.
std::optional<double> LimitOfTrim(const TrimOptions& options, const std::string& rule);

}  // namespace mocurate
