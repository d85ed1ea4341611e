#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/formats/humanact12_pickle.h"
#include "ingest/synthetic/humanact12_set.h"
#include "ingest/synthetic/layout.h"

namespace mocurate {

/// The motion of a recording, in the studio's world, at 15 Hz.
Motion PerformRecording(const PlannedRecording& recording, const std::vector<Actor>& actors);

/// Frames of a recording that PHSPD annotated: all but some runs of frames. Sorted.
std::vector<int> AnnotatedFrames(const StudioOptions& options, const PlannedRecording& recording);

/// HumanAct12's clips of a recording as .npy below `folder_name`, and their truth; appends name and content.
Status WriteHumanAct12Clips(const StudioOptions& options, const PlannedRecording& recording, const Motion& motion,
                            const std::string& folder_name, StudioFolder& folder,
                            std::vector<std::pair<std::string, HumanAct12Clip>>& published);

}  // namespace mocurate
