#pragma once

#include <optional>
#include <string>

#include "ingest/options.h"

namespace mocurate {

/// For files whose names say nothing, as of a set that was renamed: where ingest.path is a file whose name is not as
/// ingest.source.files has it, or a folder that holds no such file but others with the pattern's ending, the pattern
/// becomes one of any name with that ending. What names a clip by fields that the pattern lacks is then not known:
/// recordings are called as their files, the person `kUnknownPerson`, without label, session, view and style. All else
/// of the declaration stays. `for_these_files`: the pattern was declared for these files; fields it lacks are unknown.
/// Returns what to say of it; nothing where nothing changes, as of containers and of clips that are many files.
std::optional<std::string> RelaxFilePattern(bool for_these_files, IngestOptions& options);

}  // namespace mocurate
