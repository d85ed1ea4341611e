#pragma once

#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/pipeline/runner.h"
#include "ingest/discover.h"
#include "ingest/options.h"
#include "ingest/sources/babel_segments.h"

namespace mocurate {

/// A file that is no item because of its name or label. `matches`: the name is as declared, but its label is not.
ItemResult SkippedFile(const std::string& name, const SourceOptions& source, bool matches, const Error& why);

/// What the declaration excludes by the recording's name, or a list of known issues does.
ItemResult ExcludedFile(const std::string& item, const std::string& file, const char* code, const std::string& why,
                        const std::string& hint);

/// A file that should be an item and cannot be.
ItemResult RefusedFile(const std::string& item, const char* code, const Error& why);

/// "source_sha256" of the summary, as of items that were read; nothing where the file cannot be.
void AddSourceHash(const std::filesystem::path& file, ItemResult& result);

/// Files of a folder that lie where the pattern does not look, and a folder that is `named_so` as the pattern has its
/// files: one line for all.
ItemResult SkippedFolder(const std::string& folder, std::size_t files, bool named_so, const SourceOptions& source);

/// Annotations that speak of motions that are not there: one line for all.
ItemResult WithoutMotion(const BabelIndex& babel, const std::vector<std::string>& files);

/// Why there is nothing to ingest; `found`: names of the folder's files.
Error NothingFound(const IngestOptions& options, const Discovery& discovery, const std::vector<std::string>& found);

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
