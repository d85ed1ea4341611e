#pragma once

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
};

/// 90th percentile over joints of the joint speed of each frame, m/s, (F); central differences.
std::vector<double> FrameSpeeds(const Motion& motion);

/// Spans to keep, in order. Every span that is dropped, and every cut of more than a frame, is a finding with its rule
/// and value. May be empty.
std::vector<KeptSpan> FindSpans(const TrimOptions& options, const Clip& clip, std::vector<Finding>& findings);

}  // namespace mocurate
