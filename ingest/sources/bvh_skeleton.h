#pragma once

#include <string>
#include <vector>

#include "core/formats/bvh.h"
#include "core/motion/skeleton.h"

namespace mocurate {

/// Effect of the position channels of a BVH file on its bones. Metres, canonical axes.
struct BvhOffsets {
  /// Position channels that vary less than this are constant: writers round to 1e-6 of their unit.
  static constexpr double kConstant = 1e-6;

  struct Joint {
    Vector3d offset = Vector3d::Zero();  ///< from the parent: OFFSET, or the middle of the channels' range instead
    double slide = 0.0;                  ///< largest distance from `offset` over the clip
    bool moves = false;                  ///< further than a bone may slide
    bool above_carrier = false;          ///< the carrier itself, or an ancestor of it
  };
  std::vector<Joint> joints;
  /// The joint that carries the translation: the last one that moves on the branchless path down from the root.
  int carrier = 0;

  /// Joints from the root to the carrier.
  std::vector<int> Path(const Bvh& bvh) const;
};

/// Error kInconsistent where every joint always coincides with its parent.
Status CheckBones(const Bvh& bvh, const std::string& file);

/// `max_slide` in metres. A joint that coincides with its parent in `declared` (may be null) and not in the file
/// carries the translation, even when the person stands still.
BvhOffsets MeasureOffsets(const Bvh& bvh, const Matrix3d& metres_from_file, double max_slide, const Skeleton* declared);

/// The skeleton of a file's motion. Indices of `offset` and `target` are the file's.
struct BvhSkeleton {
  SkeletonPtr skeleton;
  int root = 0;                     ///< joint of the file that is the skeleton's root; those above it are no joints
  std::vector<int> target;          ///< joint of the skeleton; -1 above `root`
  std::vector<Vector3d> offset;     ///< from the parent, metres, canonical axes
  std::vector<double> bone_length;  ///< (J) of the skeleton
};

/// With `declared`: its names, order, mirror partners and limits; its rest offsets where the file agrees to 1e-6 m,
/// else the file's. Without: a skeleton made from the file, whose root is the carrier, as no tree of fixed bones can
/// keep both it and the joints above it in place. Error kInconsistent names a joint that has no counterpart or another
/// parent.
Expected<BvhSkeleton> MakeBvhSkeleton(const Bvh& bvh, const BvhOffsets& offsets, const SkeletonPtr& declared,
                                      const std::string& source, const std::string& file);

}  // namespace mocurate
