#pragma once

#include <nlohmann/json.hpp>

namespace mocurate {

/// Clips of one folder, format and joint count together: what one clip cannot tell, the others may.
nlohmann::json GroupsOf(const nlohmann::json& clips);

/// Handedness belongs to the recording, not to the clip: in a group of one known skeleton where at least 5 clips tell
/// and agree, it is told of those that do not tell (standing still, arms down). A clip that says otherwise gets the
/// group's value, facing and axes unknown, and a finding "handedness_outlier". Declared values stay.
void TellByGroup(nlohmann::json& clips, nlohmann::json& findings);

}  // namespace mocurate
