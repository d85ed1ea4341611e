#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/pipeline/runner.h"
#include "ingest/options.h"

namespace mocurate {

/// What a source folder holds: one item per clip for the stage `ingest` (item = clip id, input role "source"), and a
/// finding for every file that was left out and why (name does not match the pattern, ...).
struct Discovery {
  std::vector<ItemSpec> items;  ///< sorted by item
  std::vector<Finding> findings;
  std::vector<ItemSpec> truth;  ///< items for the stage `truth`, when the source knows its truth
};

/// Lists files; reads only names, never contents. With `only`, files of other names do not exist for it. Error
/// kNotFound, kConfig.
Expected<Discovery> Discover(const IngestOptions& options, const std::optional<std::set<std::string>>& only = {});

}  // namespace mocurate
