#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// Where a run writes: the folder that was named, else `name` below runs/. Error kUsage for an empty folder, kConfig
/// for a name that is no folder's (empty, '.', '..', with a '/').
Expected<std::filesystem::path> RunFolder(const std::optional<std::filesystem::path>& named, const std::string& name);

/// That a run may write there without harm to what is not ours. A folder is ours when it holds the run.json of a run;
/// another one must not hold a file that bears a name of ours. Touches nothing. Error kUsage names the first such file.
Status CheckRunFolder(const std::filesystem::path& folder);

}  // namespace mocurate
