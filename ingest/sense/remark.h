#pragma once

#include <vector>

#include "core/base/finding.h"
#include "ingest/sense/observed_clip.h"

namespace mocurate {

/// What a reader found; the frames where these are lost to it.
Remark RemarkOf(const Finding& finding);

/// What a reader of a table found whose frames are `rows` rows of the clip's.
void AddRemarks(const std::vector<Finding>& findings, ObservedClip& clip, int rows = 1);

}  // namespace mocurate
