#pragma once

#include "ingest/discover.h"

namespace mocurate {

/// The clips of a file that holds them all: one item each, which says its place in the file; in the order of the file.
/// Error kNotFound, and of the container.
Expected<Discovery> DiscoverContainer(const IngestOptions& options);

}  // namespace mocurate
