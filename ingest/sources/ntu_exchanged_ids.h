#pragma once

#include "core/formats/ntu_skeleton.h"

namespace mocurate {

/// Body ids that the tracker exchanged: from one frame to the next (10 frames at most, where people were lost) each of
/// two bodies jumps to where the other was, in the other's pose, farther than anybody gets. The mean distance of joints
/// to the other's last pose is at most 0.3 of that to its own, which is 0.3 m and more (0.1 m for each frame between).
/// "ids_exchanged" (warning) joins `skeleton.findings` for each, over the frames in which the ids are those of the
/// other; value the shorter jump, metres. `mend`: the ids are exchanged back there. No more than 100.
void NoteExchangedIds(bool mend, NtuSkeleton& skeleton);

}  // namespace mocurate
