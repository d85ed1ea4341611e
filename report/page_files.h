#pragma once

#include <string_view>

namespace mocurate {

/// A script or style of report/viewer/, or three.min.js, as it was when the program was built.
std::string_view PageFile(std::string_view name);

}  // namespace mocurate
