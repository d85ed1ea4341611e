#pragma once

#include "core/base/options.h"

namespace mocurate {

struct Motion;

/// Repeats of the last pose from which on they are padding: a person who stands still differs in the last digit.
inline constexpr int kPaddingRepeats = 5;

/// The number of frames before the padding; 0 where every frame is zero. Trailing frames that are all zero are padding:
/// joints at 0 0 0, or with rotations the root there and no joint rotated. With `repeats` so are kPaddingRepeats and
/// more copies of the last pose, equal to the last digit, unless the whole motion is one pose; and that pose itself,
/// where no joint is rotated.
int FramesWithoutPadding(const Motion& motion, bool repeats);

/// Frames that a program appends so that all motions of a file are equally long.
enum class PaddingAction {
  kNone,  ///< not looked for
  kCut,
  kKeep,  ///< counted and left
};

inline void DeclarePadding(PaddingAction& padding, OptionVisitor& v) {
  v.Choice("padding", padding,
           {{"none", PaddingAction::kNone}, {"cut", PaddingAction::kCut}, {"keep", PaddingAction::kKeep}},
           "trailing frames that are all zero or, in files of other programs, repeat the last pose: not looked for, "
           "cut, or counted and left");
}

}  // namespace mocurate
