#pragma once

#include "core/base/finding.h"
#include "ingest/sense/observed_clip.h"

namespace mocurate {

/// What a reader found; the frames where these are lost to it.
Remark RemarkOf(const Finding& finding);

}  // namespace mocurate
