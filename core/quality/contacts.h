#pragma once

#include <optional>
#include <vector>

#include "core/motion/gaps.h"

namespace mocurate {

/// When a joint of a foot counts as standing.
struct ContactLimits {
  double height = 0.05;     ///< m above the lowest 5 % of the joint's own places
  double speed = 0.6;       ///< m/s; a faster joint is not in contact
  double min_time_s = 0.1;  ///< shorter contacts are dropped, shorter gaps are closed
};

/// The joint of each leg that is lowest in the rest of the limb: its tip, else its ankle. Empty for a skeleton without
/// legs.
std::vector<int> FootJoints(const Skeleton& skeleton);

/// Frames in which a joint is in contact with the floor: no higher than `height` above the lowest 5 % of its own
/// places, and slower than `speed` between its neighbours in time. (F)
std::vector<bool> JointContacts(const Motion& motion, int joint, const ContactLimits& limits);

/// Mean over the frames of how deep the lowest joint of the feet lies below the floor, metres. The floor is the median
/// height of the lower foot joint of each leg in contact (y up). Empty for a skeleton without legs, or without any
/// contact.
std::optional<double> FloorPenetration(const Motion& motion, const ContactLimits& limits = {});

/// Share of the rotations of joints with limits (Skeleton::joints[].limits, rotation vector from the rest pose) that
/// lie beyond them. Nothing for motions without rotations or skeletons without limits.
std::optional<double> LimitViolations(const Motion& motion);

}  // namespace mocurate
