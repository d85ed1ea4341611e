#include "ingest/inspect/length_units.h"

#include <charconv>
#include <cmath>

#include "core/base/text.h"
#include "ingest/options.h"

namespace mocurate {
namespace {

/// The last one is the CMU database's, `length 0.45` of its .asf files, in the words of configs/sources.
constexpr const char* kUnits[] = {"m", "cm", "mm", "inch", "2.2222222222222 inch"};
constexpr int kLeastPower = -6, kMostPower = 3;
constexpr double kConfidenceInTens = 0.5;  // against a usual unit

/// "0.00001 m"
std::string InMetres(double metres) {
  const double rounded = ParseDouble(RoundedText(metres, 3)).value_or(metres);
  char buffer[64];
  const auto end = std::to_chars(buffer, buffer + sizeof(buffer), rounded, std::chars_format::fixed).ptr;
  return std::string(buffer, end) + " m";
}

/// The unit is taken if the length is a person's in it, and nearer to a typical one than what was taken before.
class BestUnit {
 public:
  BestUnit(double length, const LengthOfPeople& people) : length_(length), people_(people) {}

  void Try(const std::string& name, double metres_per_unit, double trust) {
    const double metres = length_ * metres_per_unit;
    if (!(metres >= people_.low && metres <= people_.high)) return;
    const double off = std::abs(std::log(metres / people_.typical));
    if (!name_.empty() && off > off_) return;
    off_ = off;
    name_ = name;
    metres_ = metres;
    trust_ = trust;
  }
  bool found() const { return !name_.empty(); }
  const std::string& name() const { return name_; }
  double metres() const { return metres_; }
  double confidence() const { return trust_ * std::max(0.2, 1.0 - off_ / 0.6); }

 private:
  double length_;
  LengthOfPeople people_;
  double off_ = 0.0, metres_ = 0.0, trust_ = 0.0;
  std::string name_;
};

}  // namespace

std::string ShownLength(double value) {
  if (!(value > 0.0)) return "0";
  const double step = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return step >= 1.0 ? RoundedText(std::round(value / step) * step, 9)
                     : FormatDouble(std::round(value / step) / std::round(1.0 / step));
}

Measured UnitsFromLength(double length, const LengthOfPeople& people, const std::string& what, double trust,
                         bool scaled) {
  Measured units;
  BestUnit best(length, people);
  for (const char* unit : kUnits) best.Try(unit, *MetresPerUnit(unit), trust);
  const bool usual = best.found();
  for (int power = kLeastPower; !usual && scaled && power <= kMostPower; ++power) {
    const double metres = std::pow(10.0, power);
    best.Try(InMetres(metres), metres, kConfidenceInTens * trust);
  }
  if (!best.found()) {
    units.evidence = what + " is " + ShownLength(length) + " in the file's unit; no usual unit makes that a person" +
                     (scaled ? ", nor a metre times a power of ten" : "");
    return units;
  }
  units.value = best.name();
  units.confidence = best.confidence();
  units.evidence = what + " is " + ShownLength(length) + " = " + ShownLength(best.metres()) + " m in " + best.name();
  if (!usual) units.evidence += ", which is no usual unit: numbers that were multiplied by a power of ten look so";
  return units;
}

}  // namespace mocurate
