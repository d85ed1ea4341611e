#pragma once

#include <optional>

#include "ingest/sources/source_file.h"

namespace mocurate {

/// What becomes of frames in which nothing was observed, whatever the format: frames before the first and after the
/// last observation are cut (finding "unobserved_ends"); a gap longer than `source.max_gap_s` is reported ("long_gap"),
/// and where the clip has a motion its frames become kInferred. Returns "mostly_missing" where the share of frames
/// without an observation exceeds `source.max_missing`: the clip is excluded. Findings move with the frames. Clips of a
/// store keep what was decided when they were made; `people.rule: uestc_released` fills every gap as released.
std::optional<Finding> ApplyGapRule(const SourceOptions& source, IngestedClip& ingested);

}  // namespace mocurate
