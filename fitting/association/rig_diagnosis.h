#pragma once

#include <vector>

#include "core/base/error.h"
#include "fitting/association/body_shape.h"
#include "fitting/association/rig_view.h"

namespace mocurate {

/// Why views agree on nobody: what the rays of entries seen at the same time by pairs of neighbouring views do. An
/// error kInconsistent with the numbers: too few entries or none at the same time; rays that are nearly parallel;
/// rays that meet behind the cameras; rays that miss each other.
Error WhyNobody(const std::vector<RigView>& rig);

/// Checks measured lengths (metres, 0: not measured) against a person's. Error kInconsistent for a size that no person
/// has, with the unit that would explain it, and for proportions that no person has, with the worst length.
Status CheckPersonShape(const std::vector<double>& measured, const std::vector<KnownLength>& lengths);

}  // namespace mocurate
