#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/body/skinned_body.h"
#include "core/motion/skeleton.h"

namespace mocurate {

/// One way in which bodies differ: metres per unit of its coefficient.
struct ShapeDirection : RestBody {
  std::string name;              ///< of the file, or "shape 3"
  double low = 0.0, high = 0.0;  ///< between which people's coefficients are drawn
};

/// A skinned body laid over a skeleton's joints (J), at rest: mean shape, T-pose, metres.
struct Skin : RestBody {
  std::string name;                       ///< "body_cc0" or "SMPL", for checkpoints and tables
  std::vector<double> weights;            ///< (V,J) rows sum to 1
  std::vector<double> pose_blending;      ///< (3V, 9(J-1)) vertex offsets by R - I of each joint but the root; or empty
  std::vector<std::array<int, 3>> faces;  ///< counter-clockwise seen from outside
  std::vector<ShapeDirection> shapes;     ///< the first ten at most
};

/// Of body_cc0.h5 or an SMPL file (.pkl, .npz). Joints of the body that the skeleton does not have (hands) move with
/// their parents. Error kInconsistent: a skeleton with another tree or rest pose, a body without a required joint.
Expected<Skin> ReadSkin(const std::filesystem::path& file, const Skeleton& skeleton);

/// Drawn shape coefficients (S): uniform between `low` and `high` of each direction, keyed by (`seed`, `index`).
std::vector<double> DrawShape(const Skin& skin, std::uint64_t seed, int index);

/// Whether a body's file is of one gender, by its name.
bool IsOfOneGender(const std::filesystem::path& file);

/// The body of these shape coefficients (S).
Skin Shaped(const Skin& skin, const std::vector<double>& coefficients);

/// Vertices (V) in the world of a body in a pose: `rotation` (J) parent_from_joint, the root's joint at `root`. Linear
/// blend skinning with pose-dependent offsets where the body has them.
std::vector<Vector3d> PosedVertices(const Skin& skin, const Skeleton& skeleton, const Quaterniond* rotation,
                                    const Vector3d& root);

}  // namespace mocurate
