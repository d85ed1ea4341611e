#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/motion/motion.h"
#include "core/motion/skeleton.h"

namespace mocurate {

/// Names of a detector's keypoints in its order.
struct KeypointOrder {
  std::string name;
  std::vector<std::string> points;
};

/// Orders that keypoints are looked for in where the given one makes no person: BODY_25, BODY_25B, COCO_17, COCO_18.
const std::vector<KeypointOrder>& KnownOrders();

/// An order under which the points have a person's proportions.
struct OrderFound {
  std::string name;
  std::vector<std::string> names;  ///< (K) points beyond the order's are named "unknown_0" ...
  double given = 0.0;              ///< mean departure of the lengths by |log ratio|, as named
  double found = 0.0;              ///< and in the order found
  double confidence = 0.0;         ///< that it is better than the given and any other known order
};

/// The order of `confidence` > 0 points (F,K) that gives `skeleton`'s proportions best, frame by frame, of frames that
/// show enough of a person; empty when none gives a person's, with limbs that are even on both sides: the order is then
/// one that is not known.
std::optional<OrderFound> FindKeypointOrder(const JointPositions& points, const std::vector<double>& confidence,
                                            const std::vector<std::string>& names, const Skeleton& skeleton);

}  // namespace mocurate
