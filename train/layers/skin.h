#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/motion/skeleton.h"

namespace mocurate {

/// A skinned body laid over a skeleton's joints, at rest: mean shape, T-pose, metres.
struct Skin {
  std::string name;                   ///< "body_cc0" or "SMPL", for checkpoints and tables
  std::vector<Vector3d> vertices;     ///< (V)
  std::vector<Vector3d> joints;       ///< (J) of the skeleton
  std::vector<double> weights;        ///< (V,J) rows sum to 1
  std::vector<double> pose_blending;  ///< (3V, 9(J-1)) vertex offsets by R - I of each joint but the root; or empty
};

/// Of body_cc0.h5 or an SMPL file (.pkl, .npz). Joints of the body that the skeleton lacks (hands) move with their
/// parents. Error kInconsistent: a skeleton whose tree or rest pose is another, a body that lacks a joint.
Expected<Skin> ReadSkin(const std::filesystem::path& file, const Skeleton& skeleton);

}  // namespace mocurate
