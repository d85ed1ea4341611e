#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/motion/skeleton.h"
#include "fitting/association/rig_view.h"

namespace mocurate {

inline constexpr double kShortestKnownBone = 0.1;  ///< m in the rest pose; shorter bones cannot be measured reliably

/// Two keypoints at a fixed distance on a person: the ends of a bone, or both hips, or both shoulders.
struct KnownLength {
  int from = 0;       ///< keypoint
  int to = 0;         ///< keypoint
  double rest = 0.0;  ///< metres, in the skeleton's rest pose
  std::string name;   ///< "left_hip to left_knee"
};

/// Known lengths between keypoints `names` (K): bones of the skeleton with a keypoint at both ends, hip width and
/// shoulder width.
std::vector<KnownLength> KnownLengths(const std::vector<std::string>& names, const Skeleton& skeleton);

/// Comparison of a body's lengths with those of the rest pose.
struct ShapeMatch {
  int lengths = 0;        ///< number of lengths compared
  double scale = 0.0;     ///< median ratio; 0 without lengths
  double mismatch = 0.0;  ///< mean over the lengths of |log(ratio / scale)|, each 1 at most
};
ShapeMatch CompareShape(const BodyPoints& body, const std::vector<KnownLength>& lengths);

/// Compares measured lengths (metres, 0: not measured).
ShapeMatch CompareShape(const std::vector<double>& measured, const std::vector<KnownLength>& lengths);

/// The lengths of a body, metres; 0 when an end is unknown.
std::vector<double> MeasureLengths(const BodyPoints& body, const std::vector<KnownLength>& lengths);

/// Median of each known length over the frames (points F,K; observed where `confidence` > 0); 0: not measured.
std::vector<double> MedianLengths(const JointPositions& points, const std::vector<double>& confidence,
                                  const std::vector<KnownLength>& lengths, const std::vector<int>& frames);

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
