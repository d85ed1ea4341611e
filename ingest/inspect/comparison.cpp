#include "ingest/inspect/comparison.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "ingest/checks/rate_checks.h"
#include "ingest/formats/driver.h"

namespace mocurate {
namespace {

constexpr double kContradicts = 0.55;  // least confidence of a measured value that contradicts a declared one
constexpr double kBodySlack = 0.15;    // of the body's length, before a declared unit is doubted
constexpr double kLeastBody = kShortestBody * (1.0 - kBodySlack), kLongestBody = kTallestBody * (1.0 + kBodySlack);
constexpr double kPathSlack = 2.0;       // factor by which a path may differ from the steps of a standard body
constexpr double kRateTolerance = 0.01;  // relative
constexpr double kUnitSlack = 1.5;       // factor within which a length is a usual unit

/// "-z": where a canonical direction lies in the source's axes.
std::string SourceAxis(const AxisConvention& axes, int canonical) {
  for (int i = 0; i < 3; ++i) {
    const double component = axes.canonical_from_source(canonical, i);
    if (std::abs(component) > 0.5) return std::string(component < 0.0 ? "-" : "+") + "xyz"[i];
  }
  return "";
}

/// The usual unit of `metres`, or that length.
std::string UnitName(double metres) {
  for (const char* name : {"m", "cm", "mm", "inch"}) {
    const double ratio = metres / MetresPerUnit(name).value_or(1.0);
    if (ratio > 1.0 / kUnitSlack && ratio < kUnitSlack) return name;
  }
  return "";
}

/// A path of the root in another unit than the body that it carries.
void ComparePath(const DeclaredFrame& said, const RootScale& root, double declared,
                 std::vector<Comparison>& comparisons) {
  const std::string unit = UnitName(root.factor * declared);
  const bool contradicts = root.factor > kPathSlack || root.factor < 1.0 / kPathSlack;
  comparisons.push_back(
      {MakeFinding("units_contradiction", Severity::kError, FourDecimals(root.factor),
                   "the path of the root is declared in " + said.units + ", but does not fit the body's steps" +
                       (unit.empty() ? "" : ": in " + unit + " it would") + " (" + root.evidence + ")"),
       unit, root.sure, contradicts});
}

void CompareUnits(const DeclaredFrame& said, const ClipMeasures& m, std::vector<Comparison>& comparisons) {
  if (said.units.empty() || (!(m.body > 0.0) && !m.root)) return;
  const Expected<double> declared = MetresPerUnit(said.units);
  if (!declared) return;
  if (m.root) return ComparePath(said, *m.root, *declared, comparisons);
  const double metres = m.body * *declared;
  comparisons.push_back(
      {MakeFinding("units_contradiction", Severity::kError, FourDecimals(metres),
                   "in the declared unit '" + said.units + "' the person measures " +
                       FormatDouble(FourDecimals(metres)) + " m from head to foot" +
                       (m.units.value.empty() ? "" : "; in " + m.units.value + " it would be a person")),
       m.units.value, 1.0, metres < kLeastBody || metres > kLongestBody});
}

void Compare(const char* code, const char* what, const std::string& declared, const Measured& measured,
             std::vector<Comparison>& comparisons) {
  if (declared.empty() || measured.value.empty() || measured.confidence < kContradicts) return;
  comparisons.push_back(
      {MakeFinding(code, Severity::kError, FourDecimals(measured.confidence),
                   std::string(what) + " is declared " + declared + ", the motion says " + measured.value + ", " +
                       RoundedText(100.0 * measured.confidence, 3) + " % confidence (" + measured.evidence + ")"),
       measured.value, measured.confidence, measured.value != declared});
}

}  // namespace

DeclaredFrame DeclaredFrameOf(const RawClip& clip, const std::optional<SourceOptions>& source) {
  DeclaredFrame said{clip.units, clip.up, clip.handedness, "", clip.axes, "declared by the format"};
  if (!source) return said;
  said.who = "declared by the source '" + source->name + "'";
  if (!source->units.empty()) said.units = source->units;
  const auto axes = AxisConvention::Parse(source->axes);
  if (!axes) return said;
  said.axes = source->axes;
  said.up = SourceAxis(*axes, 1);
  said.facing = SourceAxis(*axes, 2);
  said.handedness = axes->handedness() == Handedness::kLeft ? "left" : "right";
  return said;
}

double ContradictionThreshold(const std::string& code, double value, const SourceOptions& source) {
  if (code == "units_contradiction") {
    const bool path = DriverOf(source.format).lengths_assumed;
    if (path) return value > 1.0 ? kPathSlack : 1.0 / kPathSlack;
    return FourDecimals(value > kTallestBody ? kLongestBody : kLeastBody);
  }
  if (code == "up_contradiction" || code == "handedness_contradiction") return kContradicts;
  if (code == "joint_order_contradiction") return kPlausibleOrder;
  if (code == "rate_implausible") return value > kSlowestRecorded_hz ? kFastestRecorded_hz : kSlowestRecorded_hz;
  if (code == "rate_contradiction") return source.rate_hz.value_or(0.0);
  return 0.0;
}

std::optional<Finding> CompareRate(const SourceOptions& source, double file_hz) {
  if (!source.rate_hz || std::abs(file_hz / *source.rate_hz - 1.0) <= kRateTolerance) return std::nullopt;
  return MakeFinding(
      "rate_contradiction", Severity::kError, file_hz,
      "the file declares " + RoundedText(file_hz, 6) + " Hz, the source " + RoundedText(*source.rate_hz, 6) + " Hz");
}

bool RateDenials::OfTheSet() const {
  const std::size_t most = std::max(too_fast, too_slow);
  return most >= kFewestWrongRates && Share() >= kShareOfWrongRate && std::min(too_fast, too_slow) == 0;
}

std::string RateDenials::Words() const {
  return std::to_string(std::max(too_fast, too_slow)) + " of " + Counted(static_cast<long long>(clips), "clip") + " (" +
         RoundedText(100.0 * Share()) + " %) deny their rate, all as too " + (too_fast > 0 ? "fast" : "slow");
}

std::vector<Comparison> CompareFrame(const DeclaredFrame& said, const ClipMeasures& measures) {
  std::vector<Comparison> comparisons;
  CompareUnits(said, measures, comparisons);
  Compare("up_contradiction", "up", said.up, measures.up, comparisons);
  Compare("handedness_contradiction", "the frame", said.handedness, measures.handedness, comparisons);
  return comparisons;
}

}  // namespace mocurate
