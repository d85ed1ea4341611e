#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/motion/motion.h"
#include "core/motion/skeleton.h"

namespace mocurate {

/// Names of a detector's keypoints, in the detector's order.
struct KeypointOrder {
  std::string name;
  std::vector<std::string> points;
};

/// Orders to try when the declared one gives implausible proportions: BODY_25, BODY_25B, COCO_17, COCO_18.
const std::vector<KeypointOrder>& KnownOrders();

/// An order under which the points have a person's proportions.
struct OrderFound {
  std::string name;
  std::vector<std::string> names;  ///< (K); points beyond the order's are named "unknown_0" ...
  double given = 0.0;              ///< mean |log ratio| of the lengths in the declared order
  double found = 0.0;              ///< and in the order found
  double confidence = 0.0;         ///< that it is better than the declared and any other known order
};

/// The order of the points (F,K; observed where `confidence` > 0) that best fits `skeleton`'s proportions, over frames
/// with enough observed points. Empty when no known order gives plausible proportions with equal limbs on both sides.
std::optional<OrderFound> FindKeypointOrder(const JointPositions& points, const std::vector<double>& confidence,
                                            const std::vector<std::string>& names, const Skeleton& skeleton);

}  // namespace mocurate
