#pragma once

#include <filesystem>
#include <string>

#include "ingest/inspect/clip_consensus.h"
#include "ingest/inspect/declaration_writer.h"
#include "ingest/inspect/source_root.h"

namespace mocurate {

/// What names tell: `files`, with what belongs to them (skeletons, images, the container), `person` and `label`.
/// `asked`: the file or folder that was inspected.
void WriteNames(const ClipConsensus& source, const std::string& format, const std::filesystem::path& asked,
                const SourceRoot& root, DeclarationWriter& writer);

}  // namespace mocurate
