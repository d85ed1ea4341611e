#pragma once

#include <vector>

#include "core/pipeline/runner.h"
#include "ingest/options.h"

namespace mocurate {

/// Items of several cameras' files of one performance become one each, with all of their files: the source files by
/// view, then the depth images. Error kConfig: a camera twice.
Status GroupViews(const SourceOptions& source, std::vector<ItemSpec>& items);

}  // namespace mocurate
