#pragma once

#include <string>
#include <vector>

#include "core/formats/bvh.h"
#include "core/motion/skeleton.h"

namespace mocurate {

/// What the position channels of a BVH file do to its bones. Metres, canonical axes.
struct BvhOffsets {
  /// Position channels that vary less are constant: writers round to 1e-6 of their unit.
  static constexpr double kConstant = 1e-6;

  struct Joint {
    Vector3d offset = Vector3d::Zero();  ///< from the parent: OFFSET, or the middle of what the channels say instead
    double slide = 0.0;                  ///< largest distance from it over the clip
    bool moves = false;                  ///< further than a bone may slide
    bool above_carrier = false;          ///< or the carrier itself
  };
  std::vector<Joint> joints;
  /// The joint that carries the translation: the last one that moves on the branchless way down from the root.
  int carrier = 0;

  /// Joints from the root to the carrier.
  std::vector<int> Path(const Bvh& bvh) const;
};

/// Error kInconsistent where no joint ever lies elsewhere than its parent.
Status CheckBones(const Bvh& bvh, const std::string& file);

/// `max_slide` in metres. A joint that by `declared` (may be null) lies on its parent, and in the file does not,
/// carries the translation even when the person stands still.
BvhOffsets MeasureOffsets(const Bvh& bvh, const Matrix3d& metres_from_file, double max_slide, const Skeleton* declared);

/// The tree that a file's motion is told on. Indices of `offset` and `target` are the file's.
struct BvhSkeleton {
  SkeletonPtr skeleton;
  std::vector<int> target;          ///< joint of the skeleton
  std::vector<Vector3d> offset;     ///< from the parent, metres, canonical axes
  std::vector<double> bone_length;  ///< (J) of the skeleton
};

/// With `declared`, its names, order, mirror partners and limits; its rest offsets too where the file agrees to 1e-6 m,
/// otherwise the file's. Without it, a skeleton made from the file. Error kInconsistent names the joint that has no
/// counterpart or hangs elsewhere.
Expected<BvhSkeleton> MakeBvhSkeleton(const Bvh& bvh, const BvhOffsets& offsets, const SkeletonPtr& declared,
                                      const std::string& source, const std::string& file);

}  // namespace mocurate
