#pragma once

#include <string>
#include <vector>

#include "core/formats/amc.h"

namespace mocurate {

inline constexpr std::size_t kMostAmcFindings = 200;  ///< of one file

/// A bone that most frames have is damage where it is missing, and its frame joins `damaged`; one that most lack is not
/// animated. "bone_missing" for both. `frame_lines` (frames): where each begins. Error kMalformed "name:line" for the
/// first such frame where damage is not to be reported.
Status JudgeMissingBones(const std::vector<int>& frame_lines, bool reports, const std::string& name, Amc& amc);

}  // namespace mocurate
