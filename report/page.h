#pragma once

#include <string>

#include "report/sections.h"

namespace mocurate {

/// The whole page, self-contained. Same input, same bytes.
std::string MakePage(const ReportInput& input);

}  // namespace mocurate
