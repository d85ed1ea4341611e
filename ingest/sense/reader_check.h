#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "ingest/sense/observe.h"

namespace mocurate {

/// What a run would say of a file that an inspection reads, for formats whose clip is one file by itself: its findings,
/// or the error for which it refuses it. `declared_name` is the file's below the source's folder, whose name is told
/// elsewhere. Without a source, and of other formats, nothing.
Expected<std::vector<Finding>> SaidByRun(const std::optional<SourceOptions>& source, const std::string& declared_name,
                                         const FileBytes& file);

}  // namespace mocurate
