#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "fitting/association/body_shape.h"
#include "fitting/association/rig_view.h"

namespace mocurate {

/// Why views agree on no person: what the rays of entries seen at the same time by pairs of neighbouring views do. An
/// error kInconsistent with the numbers: too few entries or none at the same time; rays that are nearly parallel;
/// rays that meet behind the cameras; rays that miss each other.
Error WhyNoPerson(const std::vector<RigView>& rig);

/// A factor by which a calibration's lengths are too long when its unit is misread, and how that reads.
struct UnitMisreading {
  double factor = 1.0;
  std::string text;  ///< "millimetres read as metres"
};

/// The misreading that explains a person of `scale` times a person's size to within a factor of 1.6; none for people.
std::optional<UnitMisreading> FindUnit(double scale);

/// Checks measured lengths (metres, 0: not measured) against a person's. Error kInconsistent for a size that no person
/// has, with the unit that would explain it, and for proportions that no person has, with the worst length.
Status CheckPersonShape(const std::vector<double>& measured, const std::vector<KnownLength>& lengths);

}  // namespace mocurate
