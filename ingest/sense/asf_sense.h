#pragma once

#include <optional>
#include <vector>

#include "core/base/finding.h"
#include "core/formats/asf.h"

namespace mocurate {

/// What lengths of a skeleton cannot be, as errors. "length_unit_contradiction", value metres: a body of at least 15
/// bones whose rest pose is no person's by the file's own unit (`length` under :units; inches), outside 1 to 3 m from
/// end to end; or which is one, but of another length by `declared_m`, the metres of a unit that the source says, by
/// more than 5 %. "bone_length", value the ratio: a bone that is more than 5 times its partner of the other side
/// (lfemur, rfemur).
std::vector<Finding> DoubtLengths(const Asf& asf, std::optional<double> declared_m = std::nullopt);

}  // namespace mocurate
