#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "canon/exports/layout.h"
#include "core/base/config.h"
#include "ingest/read_motions.h"
#include "job/verbs/verbs.h"

namespace mocurate {

/// Clips selected for an export, read one at a time.
struct ClipsToExport {
  ExportSet set;                                    ///< of the chosen clips; no folder yet
  std::function<Expected<Clip>(std::size_t)> read;  ///< by the position in set.ids
  std::vector<RefusedClip> refused;                 ///< clips of the files that could not be read
};

/// A dataset of mocurate is streamed; other files are read by their declaration, all at once. Errors of reading; kUsage
/// for an unknown --clip or --split.
Expected<ClipsToExport> OpenClipsToExport(const ExportArguments& arguments, const ConfigRules& rules);

}  // namespace mocurate
