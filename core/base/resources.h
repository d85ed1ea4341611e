#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mocurate {

/// Files below configs/ that are built into the program, by their path there ("skeletons/smpl24.yaml").
std::optional<std::string_view> FindResource(std::string_view path);
std::vector<std::string> ResourcePaths();

}  // namespace mocurate
