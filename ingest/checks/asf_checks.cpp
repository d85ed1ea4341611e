#include "ingest/checks/asf_checks.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/quality/tracked_points.h"
#include "ingest/inspect/inspection.h"

namespace mocurate {
namespace {

constexpr std::size_t kBonesOfPerson = 15;                         // of a whole person
constexpr double kShortestRestPose = 1.0, kLongestRestPose = 3.0;  // metres, of a person's rest pose from end to end
constexpr double kMetresPerInch = 0.0254;
constexpr double kSameUnit = 0.05;  // of their ratio: recipes round 1 / 0.45

/// The longest side of the box around all ends of bones at rest, file units.
double ExtentAtRest(const Asf& asf) {
  std::vector<Vector3d> ends(asf.bones.size(), Vector3d::Zero());
  Vector3d low = Vector3d::Zero(), high = Vector3d::Zero();
  for (const int bone : asf.Order()) {
    const AsfBone& b = asf.bones[static_cast<std::size_t>(bone)];
    Vector3d end = AsfOffset(b);
    if (b.parent >= 0) end += ends[static_cast<std::size_t>(b.parent)];
    ends[static_cast<std::size_t>(bone)] = end;
    low = low.cwiseMin(end);
    high = high.cwiseMax(end);
  }
  return (high - low).maxCoeff();
}

}  // namespace

std::optional<Finding> CheckAsfUnit(const Asf& asf, std::optional<double> declared_m) {
  const double units = ExtentAtRest(asf);
  if (asf.bones.size() < kBonesOfPerson || !(asf.length_unit > 0.0) || !(units > 0.0)) return std::nullopt;
  const double metres = units / asf.length_unit * kMetresPerInch;
  const std::string own = "the rest pose measures " + Digits(units) + " file units from end to end; with `length " +
                          Digits(asf.length_unit) + "` in :units (file units per inch) that is " + Digits(metres) +
                          " m";
  const std::string said = declared_m ? Digits(units * *declared_m) + " m by the source's `units`" : std::string();
  std::string message;
  if (metres < kShortestRestPose || metres > kLongestRestPose) {
    message = own + " (a person: " + Digits(kShortestRestPose) + " to " + Digits(kLongestRestPose) + " m)" +
              (said.empty() ? "" : " (" + said + ")") + ": correct `length` in :units, or the lengths of the bones";
  } else if (declared_m && std::abs(units * *declared_m / metres - 1.0) > kSameUnit) {
    message = own + ", but " + said + ": correct `length` in :units, or declare ingest.source.units of this skeleton";
  } else {
    return std::nullopt;
  }
  return MakeFinding("length_unit_contradiction", Severity::kError, FourDecimals(metres), std::move(message));
}

}  // namespace mocurate
