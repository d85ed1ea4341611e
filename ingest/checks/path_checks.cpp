#include "ingest/checks/path_checks.h"

#include <cmath>

#include "core/quality/tracked_points.h"
#include "ingest/checks/root_scale.h"
#include "ingest/inspect/inspection.h"

namespace mocurate {
namespace {

constexpr double kOtherUnit = 8.0;  // least factor between two units; metres and centimetres are 100 apart

}  // namespace

std::optional<Finding> CheckRootPath(const JointPositions& places, const BodyLandmarks& body) {
  const std::optional<RootScale> scale = MeasureRootScale(places, body);
  if (!scale || !std::isfinite(scale->factor) || !(scale->factor > 0.0)) return std::nullopt;
  if (scale->factor < kOtherUnit && scale->factor > 1.0 / kOtherUnit) return std::nullopt;
  Finding finding = MakeFinding("units_contradiction", Severity::kError, FourDecimals(scale->factor),
                                "the path of the root and the lengths of the bones are of two units (" +
                                    scale->evidence + "): multiply the positions of the root by " +
                                    Digits(scale->factor) + ", or give the bones the unit of the path");
  finding.limit = scale->factor > 1.0 ? kOtherUnit : 1.0 / kOtherUnit;
  return finding;
}

}  // namespace mocurate
