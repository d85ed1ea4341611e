#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/options.h"

namespace mocurate {

/// One spelling of a unit: a value written in it times `numerator` / `denominator` is in `unit`.
struct UnitSpelling {
  std::string_view spelling;
  Unit unit;
  double numerator;
  double denominator;
};

/// Every spelling a config may use, by unit.
const std::vector<UnitSpelling>& UnitSpellings();

/// "m, dm, cm, ...".
std::string SpellingsOf(Unit unit, std::string_view separator = ", ");

/// "m", "s", "rad", "Hz", "m/s", "rad/s", "px", "B"; empty for kNone.
std::string_view Name(Unit unit);

/// "30 mm", "1/30 s", "2.5": the value in `unit`. A number without a unit is taken in `unit`. Error kConfig names the
/// text and what is expected; its `where` is empty.
Expected<double> ParseQuantity(std::string_view text, Unit unit);

/// "0.25 m", "3".
std::string QuantityText(double value, Unit unit);

bool IsInside(double value, const Range& range);
/// "0 to 10 m/s", "at least 0 m", "at most 1"; empty when nothing is bounded.
std::string RangeText(const Range& range, Unit unit);

}  // namespace mocurate
