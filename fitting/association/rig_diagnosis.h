#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "fitting/association/body_shape.h"
#include "fitting/association/rig_view.h"

namespace mocurate {

/// Explains why views agree on no person, from rays of entries that pairs of neighbouring views observe at one time.
/// Returns an error kInconsistent with numbers. Causes: too few entries, or none at one time; nearly parallel rays;
/// rays that meet behind the cameras; rays that miss each other.
Error WhyNoPerson(const std::vector<RigView>& rig);

/// A factor by which the calibration's lengths are too long because of a wrong unit, and its text.
struct UnitMisreading {
  double factor = 1.0;
  std::string text;  ///< "millimetres read as metres"
};

/// The wrong unit that explains a person `scale` times a person's size, within a factor of 1.6. Empty for a plausible
/// size.
std::optional<UnitMisreading> FindUnit(double scale);

/// Compares measured lengths (metres, 0: not measured) with a person's. Error kInconsistent for an implausible size,
/// with the unit that explains it, and for implausible proportions, with the worst length.
Status CheckPersonShape(const std::vector<double>& measured, const std::vector<KnownLength>& lengths);

}  // namespace mocurate
