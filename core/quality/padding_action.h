#pragma once

#include "core/base/options.h"

namespace mocurate {

/// Frames that a program appends so that all motions of a file are equally long (core/quality/padding.h).
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
