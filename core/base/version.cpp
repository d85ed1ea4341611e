#include "core/base/version.h"

namespace mocurate {

std::string_view Version() { return MOCURATE_VERSION; }

std::string_view CreatedBy() { return "mocurate " MOCURATE_VERSION; }

}  // namespace mocurate
