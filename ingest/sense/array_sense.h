#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/formats/npy.h"

namespace mocurate {

struct AxisOrder {
  std::string words;    ///< "its axes are (joints, frames, 3), ..."
  std::string way_out;  ///< "write it with numpy's transpose(1, 0, 2)"
};

/// An array (a, b, 3), (a, 3, b) or (3, a, b) whose axes are in another order than (frames, joints, 3): in that order
/// the points are a body (a known order of joints, or pairs that keep their distance), as they lie they are none.
/// `joints`: how many a source declares, which is enough where they lie along another axis; 0: not known.
std::optional<AxisOrder> ExchangedAxes(const NpyArray& array, std::size_t joints);

/// Frames of (frames, joints, 3) numbers of which one is none ("not_a_number") or beyond any person
/// ("number_too_large"): a finding each, of the first such number; action "dropped".
std::vector<Finding> DamagedFramesOf(const double* xyz, int frames, int joints, const std::string& name);

}  // namespace mocurate
