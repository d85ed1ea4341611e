#pragma once

#include <string>
#include <vector>

#include "core/pipeline/stage.h"
#include "core/store/store.h"

namespace mocurate {

/// The input of a role; null when there is none.
const StageInput* FindInput(const StageRequest& request, const std::string& role);

/// The one clip of a Dataset or an evidence artifact, with its motion. `findings`, if not null, gets those of the file.
/// Error kInconsistent where it has none.
Expected<Clip> ReadMotionClip(const StageInput& input, std::vector<Finding>* findings);

/// LevelClip by the floor that the stage `level` found; nothing where it found none. Error kMalformed.
Status LevelByFloor(const StageInput& input, Clip& clip);

void SortById(std::vector<Clip>& clips);

/// {"name", "train", "validation", "test" (counts), "rule", "leak_check"}
nlohmann::json SplitSummary(const Split& split);

}  // namespace mocurate
