#pragma once

#include <optional>
#include <string>
#include <vector>

#include "canon/options.h"
#include "core/base/finding.h"
#include "core/motion/clip.h"

namespace mocurate {

/// Frames [begin, end) of a clip that are kept, with the label they get.
struct KeptSpan {
  int begin = 0;
  int end = 0;
  std::string label;
  std::string fine_label;
  double confidence = 1.0;  ///< in [0, 1] of the less confident end, where a rule estimates them (EstimatesCuts)
};

/// Whether a rule estimates where cuts are: change_points, cycles, by_example.
bool EstimatesCuts(TrimRule rule);

/// Speed of the fastest joint in each frame, m/s, (F): the slope of a line fitted to the joint over the `window_s`
/// seconds around the frame, at least its two neighbours (shifted inwards at the ends, so that no frame is measured
/// over less). White noise of s metres at F frames in the window moves the slope by about 3.5 s / (window_s sqrt(F)).
std::vector<double> FrameSpeeds(const Motion& motion, double window_s);

/// Spans to keep, in order. Every span that is dropped, and every cut of more than a frame, is a finding with its rule
/// and value. May be empty.
std::vector<KeptSpan> FindSpans(const TrimOptions& options, const Clip& clip, std::vector<Finding>& findings);

/// The spans that last options.min_length_s at least; the others are findings ("too_short").
std::vector<KeptSpan> LongEnough(const TrimOptions& options, const Clip& clip, const std::vector<KeptSpan>& spans,
                                 std::vector<Finding>& findings);

/// What the value of a dropped span is held against: "too_short" in seconds, "never_moves" in m/s; of other rules none.
std::optional<double> LimitOfTrim(const TrimOptions& options, const std::string& rule);

}  // namespace mocurate
