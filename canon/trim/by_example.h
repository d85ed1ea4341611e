#pragma once

#include <map>
#include <string>
#include <vector>

#include "canon/options.h"
#include "canon/trim/trim.h"
#include "core/base/error.h"
#include "core/motion/motion.h"

namespace mocurate {

/// Other occurrences of an action with a few marked examples.
///
/// Each example is aligned with every part of the recording by subsequence dynamic time warping (Mueller 2007), where a
/// part may be up to twice as fast or slow. Compared are the body's poses and velocities without position, heading and
/// stature. A span's distance is that of the alignment divided by the median of all parts of the recording, which
/// should therefore contain other actions too. Spans do not overlap: of two the nearer one stays. Spans below
/// `min_confidence` are dropped; spans less than `join_gap_s` apart are merged, because an action may have more
/// repetitions than an example.
///
/// In order of time, without labels; the confidence is that the span shows the action. Error kUsage without an example
/// of at least two frames; kInconsistent where the trees of joints differ.
Expected<std::vector<KeptSpan>> FindByExample(const ByExampleOptions& options, const std::vector<Motion>& examples,
                                              const Motion& recording);

/// FindByExample for several labels: where spans of two labels overlap the more confident one stays. In order of time,
/// with the labels. Errors of FindByExample.
Expected<std::vector<KeptSpan>> SpansByExample(const ByExampleOptions& options,
                                               const std::map<std::string, std::vector<Motion>>& examples,
                                               const Motion& recording);

}  // namespace mocurate
