#pragma once

#include <string_view>

namespace mocurate {

/// "0.1.0", from the project's CMakeLists.txt.
std::string_view Version();

/// "mocurate 0.1.0", the creator recorded in files.
std::string_view CreatedBy();

}  // namespace mocurate
