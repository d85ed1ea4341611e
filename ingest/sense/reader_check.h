#pragma once

#include <optional>
#include <string>

#include "core/base/error.h"
#include "ingest/sense/observe.h"

namespace mocurate {

/// Why a run would refuse a file that an inspection reads: what the reader of its source's format says of it, for
/// formats whose clip is one file by itself. `declared_name` is the file's below the source's folder. Without a source
/// that of PHSPD, whose folders have names of their own. Nothing where the reader takes the file.
std::optional<Error> RefusedByReader(const std::optional<SourceOptions>& source, const std::string& declared_name,
                                     const FileBytes& file);

}  // namespace mocurate
