#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "core/base/error.h"

namespace mocurate {

/// Differences of two datasets, with clips matched by id: {"added": [clip], "removed": [clip], "relabelled": [{clip,
/// before, after}], "refitted": [{clip, frames_before, frames_after, joint_mm, rotation_deg}], "moved": [{clip, split,
/// before, after}], "splits_added", "splits_removed": [name], "changed": [{clip, field (rate, fine_label, licence,
/// segments), before, after}], "dataset": [{field (skeleton, axes, labels, recipe, other_fields), before, after}],
/// "equal": clips that differ in none of these}. `joint_mm` is the mean distance over frames and joints, `rotation_deg`
/// the mean angle; null where the numbers of frames or the trees of joints differ (each clip is refitted then), or
/// there are no rotations. Both are read clip by clip. Errors of ReadDataset.
Expected<nlohmann::json> DiffDatasets(const std::filesystem::path& before, const std::filesystem::path& after);

}  // namespace mocurate
