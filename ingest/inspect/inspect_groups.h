#pragma once

#include "ingest/inspect/inspection.h"

namespace mocurate {

/// Fills `groups`: clips of one folder, format and joint count together. Rates that enough motions of a folder deny are
/// "rate_suspect" of the folder (RateDenials).
void CompareGroups(Inspection& inspection);

}  // namespace mocurate
