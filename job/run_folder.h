#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "job/config_loading.h"

namespace mocurate {

/// Output folder of a run: the given one, else `name` below runs/. Error kUsage for an empty path, kConfig for an
/// invalid name (empty, '.', '..', with a '/').
Expected<std::filesystem::path> RunFolder(const std::optional<std::filesystem::path>& named, const std::string& name);

/// Error kCannotWrite for a link, a pipe or a device among the files and folders that verbs write in a run folder,
/// which somebody else may have sent. The folder itself may be a link.
Status CheckRunFiles(const std::filesystem::path& folder);

/// Checks that a run may write there: CheckRunFiles, also of the sets of the job. A folder with the run.json of a run
/// must be of the same job: the same name, from the same configuration file, whatever its options; `replace` allows
/// another. A folder without one must not contain a file with the name of an output. Changes nothing. Error kUsage
/// names both jobs, or the first such file.
Status CheckRunFolder(const std::filesystem::path& folder, const LoadedJob& job, bool replace);

}  // namespace mocurate
