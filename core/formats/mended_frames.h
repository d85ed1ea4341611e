#pragma once

#include <string>
#include <string_view>

#include "core/formats/joint_table.h"
#include "core/formats/row_frames.h"

namespace mocurate {

/// Where a table ends in the middle of a frame and every row continues its joint: whether the last frame is cut off, or
/// the first one has a row too few or too many.
enum class OddFrame { kLast, kFirst };

/// Cuts a table of one joint per row into its frames anew where a row is missing or too many: such a frame is NaN, in
/// its place, with a finding "frame_rows". `rows` says which columns are x, y and z; `bytes` and `said` are what the
/// table was read from. Error kMalformed "name:line" instead, where damaged rows are to be refused.
Status MendFrames(JointPerRow rows, OddFrame odd, std::string_view bytes, const JointTableLayout& said,
                  const std::string& name, JointTable& table);

}  // namespace mocurate
