#pragma once

#include <optional>
#include <string>
#include <vector>

#include "canon/audit/clip_errors.h"
#include "canon/options.h"

namespace mocurate {

/// One number about a clip, defined alike for all clips of a dataset.
struct MeasureKind {
  const char* name;
  const char* unit;
  /// Which side of its class is an outlier: +1 the high one, -1 the low one, 0 both.
  int side;
  double grain;                       ///< differences below it are ignored, in the measure's unit
  double (*value)(const Clip& clip);  ///< NaN where a clip does not have it
};

/// In the order of their columns: seconds, jerk, foot_skate, floor_penetration, bone_spread, limit_share, top_speed,
/// observed_share, fit_rms.
const std::vector<MeasureKind>& MeasuresOfClips();

/// (clips, measures); NaN where a clip does not have one.
std::vector<std::vector<double>> MeasureClips(const Dataset& dataset);

/// "outlier" (info): clips with a measure further from the median of its class than `options.deviations` robust
/// standard deviations. Measures without an upper bound are compared on a logarithmic scale above their grain. Listed
/// is the worst measure of a clip, the furthest clips first. Classes of fewer than eight are compared
/// with the whole set.
std::vector<AuditFinding> FindOutliers(const Dataset& dataset, const std::vector<std::vector<double>>& measures,
                                       const OutlierOptions& options);

}  // namespace mocurate
