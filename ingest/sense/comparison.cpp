#include "ingest/sense/comparison.h"

#include <cmath>

#include "core/base/text.h"

namespace mocurate {
namespace {

constexpr double kContradicts = 0.55;  // least confidence of a measured value that contradicts a declared one
constexpr double kBodySlack = 0.15;    // of the body's length, before a declared unit is doubted

double Rounded(double value) { return std::round(value * 1e4) / 1e4; }

/// "-z": where a canonical direction lies in the source's axes.
std::string SourceAxis(const AxisConvention& axes, int canonical) {
  for (int i = 0; i < 3; ++i) {
    const double component = axes.canonical_from_source(canonical, i);
    if (std::abs(component) > 0.5) return std::string(component < 0.0 ? "-" : "+") + "xyz"[i];
  }
  return "";
}

void CompareUnits(const Statements& said, const ClipMeasures& m, std::vector<Comparison>& comparisons) {
  if (said.units.empty() || !(m.body > 0.0)) return;
  const Expected<double> declared = MetresPerUnit(said.units);
  if (!declared) return;
  const double metres = m.body * *declared;
  Comparison units{"units_contradiction", said.units, m.units.value, Rounded(metres), 1.0, false, ""};
  units.contradicts = metres < kShortestBody * (1.0 - kBodySlack) || metres > kTallestBody * (1.0 + kBodySlack);
  units.message = "in the declared unit '" + said.units + "' the person measures " + FormatDouble(Rounded(metres)) +
                  " m from head to foot" +
                  (m.units.value.empty() ? "" : "; in " + m.units.value + " it would be a person");
  comparisons.push_back(std::move(units));
}

void Compare(const char* code, const char* what, const std::string& declared, const Measured& measured,
             std::vector<Comparison>& comparisons) {
  if (declared.empty() || measured.value.empty() || measured.confidence < kContradicts) return;
  comparisons.push_back({code, declared, measured.value, Rounded(measured.confidence), measured.confidence,
                         measured.value != declared,
                         std::string(what) + " is declared " + declared + ", the motion says " + measured.value + " (" +
                             measured.evidence + ")"});
}

}  // namespace

Statements StatementsOf(const ObservedClip& clip, const std::optional<SourceOptions>& source) {
  Statements said{clip.units, clip.up, clip.handedness, "", "", "said by the format"};
  if (!source) return said;
  said.who = "said by the source '" + source->name + "'";
  if (!source->units.empty()) said.units = source->units;
  const auto axes = AxisConvention::Parse(source->axes);
  if (!axes) return said;
  said.axes = source->axes;
  said.up = SourceAxis(*axes, 1);
  said.facing = SourceAxis(*axes, 2);
  said.handedness = axes->handedness() == Handedness::kLeft ? "left" : "right";
  return said;
}

std::vector<Comparison> CompareFrame(const Statements& said, const ClipMeasures& measures) {
  std::vector<Comparison> comparisons;
  CompareUnits(said, measures, comparisons);
  Compare("up_contradiction", "up", said.up, measures.up, comparisons);
  Compare("handedness_contradiction", "the frame", said.handedness, measures.handedness, comparisons);
  return comparisons;
}

}  // namespace mocurate
