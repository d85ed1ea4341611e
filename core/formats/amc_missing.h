#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/formats/amc.h"

namespace mocurate {

inline constexpr std::size_t kMostAmcFindings = 200;  ///< of one file

/// Where a bone that most frames have is missing, the frame is added to `damaged`. A bone that is missing in most
/// frames is not animated. Both are reported as "bone_missing". `frame_lines` (frames): where each begins. Error
/// kMalformed "name:line" for the first damaged frame where damage is not to be reported.
Status CheckMissingBones(const std::vector<int>& frame_lines, bool reports, const std::string& name, Amc& amc);

/// Inserts a damaged frame for each number that is skipped, so that later frames keep their time: "time_gap" replaces
/// "frame_number" there. Numbers that step by more than one throughout, or fall, are left as they are. Error
/// kInconsistent at "name" where more than 10000 are skipped; that of `fits` for the count of frames with these.
Status LeaveAmcGaps(const std::string& name, const std::function<Status(std::size_t frames)>& fits, Amc& amc);

}  // namespace mocurate
