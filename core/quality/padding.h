#pragma once

#include "core/motion/motion.h"

namespace mocurate {

/// Repeats of the last pose from which on they are padding: a person who stands still differs in the last digit.
inline constexpr int kPaddingRepeats = 5;

/// The number of frames before the padding; 0 where every frame is zero. Trailing frames that are all zero are padding:
/// joints at 0 0 0, or with rotations the root there and no joint rotated. With `repeats` so are kPaddingRepeats and
/// more copies of the last pose, equal to the last digit, unless the whole motion is one pose; and that pose itself,
/// where no joint is rotated.
int FramesWithoutPadding(const Motion& motion, bool repeats);

}  // namespace mocurate
