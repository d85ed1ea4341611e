#pragma once

#include <optional>
#include <string>

#include "ingest/inspect/raw_clip.h"

namespace mocurate {

/// What a clip shows against the names of its points, with `score` of `bones` in that order: the head lies on the hips'
/// side of the shoulders, or two points that change their names make a much better body. Nothing of fewer than 8
/// frames.
std::optional<std::string> CheckJointOrder(const RawClip& clip, const BodyScore& score,
                                           const std::vector<RawBone>& bones);

}  // namespace mocurate
