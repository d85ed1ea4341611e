#pragma once

#include <optional>
#include <vector>

#include "core/base/finding.h"
#include "core/formats/asf.h"

namespace mocurate {

/// What a skeleton cannot be, as errors; `file` is for messages. "length_unit_contradiction", value metres: a body of
/// at least 15 bones whose rest pose is no person's by the file's own unit (`length` under :units; inches), outside 1
/// to 3 m from end to end; or which is one, but of another length by `declared_m`, the metres of a unit that the source
/// says, by more than 5 %. "bone_length", value 0: a bone has no length, and its partner of the other side
/// (lfemur, rfemur) has one, or all others of a person.
std::vector<Finding> CheckAsfSkeleton(const Asf& asf, const std::string& file,
                                      std::optional<double> declared_m = std::nullopt);

}  // namespace mocurate
