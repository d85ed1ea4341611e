#pragma once

#include <set>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/pipeline/runner.h"
#include "ingest/options.h"

namespace mocurate {

/// A name in a list of the configuration that nothing has: "exclude" and its like then do nothing. Code
/// "name_unmatched", a warning with the nearest name there is. `option`: where the list stands; `kind`: what it names.
Finding UnmatchedName(const std::string& option, const std::string& kind, const std::string& name,
                      const std::set<std::string>& known);

/// Recordings that ingest.source.exclude names and that are not there.
void NoteUnmatched(const SourceOptions& source, const std::set<std::string>& recordings,
                   std::vector<Finding>& findings);

/// Whether a name ends as only motions of the source's format do: .skeleton, .bvh, .amc, pose.txt.
bool EndsAsMotion(const SourceOptions& source, const std::string& name);

/// A finding "name_mismatch" about such files that `other_files: ignore` passes over.
void NotePassedOver(const SourceOptions& source, const std::vector<std::string>& names, std::vector<Finding>& findings);

/// Looks at the beginnings of up to three files. Error kConfig where all of them are of one other known format than
/// ingest.source.format, which it names.
Status CheckFormat(const SourceOptions& source, const std::vector<ItemSpec>& items);

}  // namespace mocurate
