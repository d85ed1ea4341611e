#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "ingest/options.h"
#include "ingest/sources/pattern.h"

namespace mocurate {

/// The name of a file as the pattern sees it: with as many folders above it as the pattern has at least.
std::string NameInSource(const std::filesystem::path& file, const NamePattern& pattern);

/// Where ingest.path is one file whose name is not as ingest.source.files has it, the pattern becomes that name: what
/// names a clip by fields of the pattern is then not known: the recording is called as the file, the person
/// `kUnknownPerson`, without label, session, view and style. What is declared as a fixed text stays, as does all else.
/// Returns what to report of it; nothing where nothing changes, as of containers and of clips that are many files.
std::optional<std::string> RelaxFilePattern(IngestOptions& options);

}  // namespace mocurate
