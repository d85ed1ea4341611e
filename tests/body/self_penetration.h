#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/motion/motion.h"

namespace mocurate {

struct SelfPenetrationOptions {
  double threshold = 0.03;  ///< metres; a frame whose depth is larger counts as penetrating
};

/// How far the limbs of one person lie inside the person's other parts, per frame. F frames.
struct SelfPenetration {
  std::vector<double> depth;               ///< (F) metres, of the pair of capsules that lies deepest; 0: none
  std::vector<std::array<int, 2>> joints;  ///< (F) joints whose frames carry that pair; -1, -1 where depth is 0
  double mean_depth = 0.0;                 ///< metres, over all frames
  double penetrating_share = 0.0;          ///< of frames deeper than the threshold

  double max_depth() const;  ///< metres; 0 without frames
};

/// The depth of two capsules is the sum of their radii less the distance of their axes, less what the two overlap in
/// the rest pose of the skeleton with this person's bone lengths (for joints only: mean lengths over the frames). It is
/// at most the sum of the radii: a limb that passes through another is deepest where the axes meet.
///
/// Compared are parts of different limbs; forearms, hands, shins and feet with the trunk and the head; hands with upper
/// arms and feet with thighs of the same side. Not compared are parts that meet at a joint, and upper arms and thighs
/// with the trunk, where skin folds.
///
/// Capsules are those of CapsuleBody (for SMPL's joints the volume of the CC0 template); a motion of joints only has
/// one per bone (BoneCapsules). The two differ by centimetres: compare values of one type of body only.
///
/// Empty for a skeleton in which LimbsOf finds no elbows and knees. The limbs must be apart in the rest pose, as in a
/// T-pose.
std::optional<SelfPenetration> MeasureSelfPenetration(const Motion& motion, const SelfPenetrationOptions& options = {});

/// Least distance of two segments, metres; coinciding ends make a point.
double SegmentDistance(const Vector3d& a_begin, const Vector3d& a_end, const Vector3d& b_begin, const Vector3d& b_end);

}  // namespace mocurate
