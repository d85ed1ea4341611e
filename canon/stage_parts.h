#pragma once

#include <string>
#include <vector>

#include "core/pipeline/stage.h"
#include "core/store/store.h"

namespace mocurate {

/// The single clip of a Dataset or an evidence artifact, with its motion. `findings`, if not null, receives the file's.
/// Error kInconsistent for a clip without motion.
Expected<Clip> ReadMotionClip(const StageInput& input, std::vector<Finding>* findings);

/// LevelClip with the floor of the stage `level`; no change where it found none. Error kMalformed.
Status LevelByFloor(const StageInput& input, Clip& clip);

/// A motion that is sampled at another rate than its own must not have its frames further apart than is interpolated
/// (kMaxGap_s). Error kInconsistent.
Status CheckFrameSteps(const Clip& clip);

void SortById(std::vector<Clip>& clips);

}  // namespace mocurate
