#pragma once

#include <string>

#include "ingest/inspect/measure.h"

namespace mocurate {

/// How long something of a person is, metres.
struct LengthOfPeople {
  double typical = 0.0;
  double low = 0.0;
  double high = 0.0;
};

/// The unit in which `length` is one of a person: metres, centimetres, millimetres, inches, the CMU database's unit.
/// Where none of them is and `scaled`, a metre times a power of ten, less sure: "0.00001 m" where millimetres were
/// multiplied by 100. No value where nothing fits; the evidence then says so. `trust`: confidence at the typical
/// length.
Measured UnitsFromLength(double length, const LengthOfPeople& people, const std::string& what, double trust,
                         bool scaled);

/// Three digits.
std::string ShownLength(double value);

}  // namespace mocurate
