#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "core/base/error.h"
#include "ingest/inspect/inspection.h"
#include "ingest/options.h"
#include "ingest/sources/video.h"

namespace mocurate {

/// What video files are, one answer per file, in order: their decoders stand in a program of their own.
using VideoProbe = std::function<std::vector<Expected<VideoFacts>>(const std::vector<std::filesystem::path>& files)>;

/// Called after every file: how many are read, of how many.
using InspectProgress = std::function<void(std::size_t done, std::size_t all)>;

/// What a file or folder is. docs/inspect.md is the contract. With a source declaration its statements are compared
/// with the data. A file that cannot be read gives no clips and a finding of severity error. Without `videos` a video
/// file is only named.
Inspection InspectPath(const std::filesystem::path& path, const std::optional<SourceOptions>& source,
                       const VideoProbe& videos = {}, const InspectProgress& progress = {});

}  // namespace mocurate
