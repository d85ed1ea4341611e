#pragma once

#include <optional>

#include "core/base/finding.h"
#include "core/formats/asf.h"

namespace mocurate {

/// "length_unit_contradiction", an error whose value is metres: a skeleton of at least 15 bones whose rest pose is no
/// person's by the file's own unit (`length` under :units; inches), outside 1 to 3 m from end to end; or which is one,
/// but of another length by `declared_m`, the metres of a unit that the source declares, by more than 5 %.
std::optional<Finding> CheckAsfUnit(const Asf& asf, std::optional<double> declared_m = std::nullopt);

}  // namespace mocurate
