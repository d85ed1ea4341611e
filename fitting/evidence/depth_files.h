#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/pipeline/stage.h"

namespace mocurate {

/// Where the depth images of a request lie (inputs of role "depth"), by their names in the source's folder.
std::map<std::string, std::filesystem::path> DepthFilesOf(const StageRequest& request);

}  // namespace mocurate
