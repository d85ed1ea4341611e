#pragma once

#include "core/pipeline/stage.h"

namespace mocurate {

/// At most 30 clips of one person (inputs role "evidence", item = person) -> JSON artifact {"person", "skeleton",
/// "bone_length_m": {joint: length}, "clips", "frames", "scale"...}: one set of bone lengths, rounded to 0.1 mm.
/// Summary: standard deviation of each bone over frames before the fit (mm), stature.
Expected<StageOutcome> ProportionsStage(const StageRequest& request);

/// Keypoints of takes of one rig (role "evidence") -> RigFile (YAML): the rig audited with all takes together. Clips of
/// one recording count once. Summary: takes, cameras with verdict and confidence, faults.
Expected<StageOutcome> RigStage(const StageRequest& request);

/// One clip: evidence (role "evidence") and its person's proportions (role "proportions") -> Dataset file with one clip
/// that has a motion with rotations. Summary: method, residual_rms_mm, residual_p95_mm, iterations, termination, and
/// "before"/"after" objects: bone_spread_mm, jerk, missing_share, frames.
Expected<StageOutcome> FittingStage(const StageRequest& request);

/// What the runner must know of each stage; versions are in options.cpp.
StageDeclaration RigDeclaration();
StageDeclaration ProportionsDeclaration();
StageDeclaration FittingDeclaration();

}  // namespace mocurate
