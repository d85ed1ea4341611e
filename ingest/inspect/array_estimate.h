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

/// Numbers of (frames, joints, 3) that are none, or beyond any person: frames that hold some, rising, and a finding for
/// all that are not finite ("not_a_number") and for all that are too large ("number_too_large"), with their count as
/// value and the place of the first; action "dropped".
struct DamagedNumbers {
  std::vector<int> frames;
  std::vector<Finding> findings;
};
DamagedNumbers DamagedNumbersOf(const double* xyz, int frames, int joints, const std::string& name);

/// The error of an array whose numbers are all damaged.
tl::unexpected<Error> NoValidSamples(std::size_t numbers, const std::string& name);

}  // namespace mocurate
