#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// Output folder of a run: the given one, else `name` below runs/. Error kUsage for an empty path, kConfig for an
/// invalid name (empty, '.', '..', with a '/').
Expected<std::filesystem::path> RunFolder(const std::optional<std::filesystem::path>& named, const std::string& name);

/// Checks that a run may write there without overwriting files of the user. A folder with the run.json of a run is
/// ours; another one must not contain a file with the name of an output. Changes nothing. Error kUsage names the first
/// such file.
Status CheckRunFolder(const std::filesystem::path& folder);

}  // namespace mocurate
