#pragma once

#include <string>
#include <vector>

#include "core/motion/skeleton.h"
#include "fitting/association/rig_view.h"

namespace mocurate {

/// Two keypoints that a person holds at a distance: the ends of a bone, or the hips, or the shoulders.
struct KnownLength {
  int from = 0;       ///< keypoint
  int to = 0;         ///< keypoint
  double rest = 0.0;  ///< metres, of the skeleton's rest pose
  std::string name;   ///< "left_hip to left_knee"
};

/// Those of the limbs that a skeleton knows among keypoints by name (K): bones whose both ends are seen, hips and
/// shoulders from side to side.
std::vector<KnownLength> KnownLengths(const std::vector<std::string>& names, const Skeleton& skeleton);

/// How the lengths of a body compare with those of the rest pose.
struct ShapeMatch {
  int lengths = 0;        ///< that could be compared
  double scale = 0.0;     ///< median ratio; 0 without lengths
  double mismatch = 0.0;  ///< mean over the lengths of |log(ratio / scale)|, each 1 at most
};
ShapeMatch CompareShape(const BodyPoints& body, const std::vector<KnownLength>& lengths);

/// Measured lengths (metres, 0: not measured) in the place of a body.
ShapeMatch CompareShape(const std::vector<double>& measured, const std::vector<KnownLength>& lengths);

/// The lengths themselves, 0 where an end is not known.
std::vector<double> MeasureLengths(const BodyPoints& body, const std::vector<KnownLength>& lengths);

}  // namespace mocurate
