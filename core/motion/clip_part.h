#pragma once

namespace mocurate {

/// Which part of a sample [previous action, transition, action] is meant (multiact.md A.3).
enum class ClipPart { kWhole, kTransition, kAction };

}  // namespace mocurate
