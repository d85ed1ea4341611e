#pragma once

#include <array>
#include <string>

#include "core/base/error.h"

namespace mocurate {

struct Clip;
struct Motion;

/// Which part of a sample [previous action, transition, action] is meant (multiact.md A.3).
enum class ClipPart { kWhole, kTransition, kAction };

/// The three parts of a sample of MultiAct: they follow each other and fill the clip.
struct ActionParts {
  std::array<int, 3> frames{};       ///< of previous action (0: the clip begins behind it), transition, action
  std::array<std::string, 3> label;  ///< theirs
};

/// Of a clip with a motion. Error kInconsistent for a clip whose segments are not three parts that fill it, or the last
/// two of them.
Expected<ActionParts> PartsOf(const Clip& clip);

/// A part of a motion, in the same world frame. Errors of PartsOf.
Expected<Motion> TakePart(const Clip& clip, ClipPart part);

}  // namespace mocurate
