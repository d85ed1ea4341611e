#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/geometry/rotation.h"

namespace mocurate {

/// A degree of freedom of the root or of a bone; kLength stretches the bone.
enum class AcclaimChannel { kTx, kTy, kTz, kRx, kRy, kRz, kLength };

inline bool IsTranslation(AcclaimChannel channel) { return channel <= AcclaimChannel::kTz; }
inline bool IsRotation(AcclaimChannel channel) {
  return channel >= AcclaimChannel::kRx && channel <= AcclaimChannel::kRz;
}

/// A rotation as Acclaim writes it: angle i, in the file's unit, about the axis that letter i of the order names; the
/// first letter is applied first, about fixed axes.
struct AcclaimAxis {
  Vector3d angles = Vector3d::Zero();
  std::string order = "XYZ";
};

/// In the angle unit of the file (kLength: in its length unit); infinite for "inf".
struct AsfLimit {
  double least = 0.0;
  double most = 0.0;
};

struct AsfBone {
  int line = 0;  ///< of the file that it was read from, where it begins; not written
  int id = 0;
  std::string name;
  int parent = -1;                        ///< bone; -1: the root
  Vector3d direction = Vector3d::Zero();  ///< world axes, at rest; as written, not always of length 1
  double length = 0.0;                    ///< file units
  AcclaimAxis axis;                       ///< world_from_bone at rest
  std::vector<AcclaimChannel> dof;        ///< in the order of the numbers in an AMC; empty: never in it
  std::vector<AsfLimit> limits;           ///< one per dof, or none
};

/// Acclaim skeleton file. Lengths and angles in the file's own units.
struct Asf {
  double length_unit = 1.0;                      ///< length in the file / length_unit = inches, at Vicon and CMU
  bool degrees = true;                           ///< `angle deg`; false: `angle rad`
  std::vector<AcclaimChannel> root_order;        ///< of the numbers of `root` in an AMC
  std::string root_axis = "XYZ";                 ///< order of root_orientation
  Vector3d root_position = Vector3d::Zero();     ///< file units; replaced by the AMC's root
  Vector3d root_orientation = Vector3d::Zero();  ///< angle unit of the file
  std::vector<AsfBone> bones;                    ///< in the order of :bonedata; parents may come later, see Order()
  std::vector<Finding> findings;                 ///< "bone_id_twice", "root_axis_missing"

  int Find(std::string_view bone) const;  ///< -1: none
  /// Bones, parents before children.
  std::vector<int> Order() const;
  double RadiansPerUnit() const;
};

/// Comments (#) anywhere, LF or CRLF, keys and channels in any letter case, sections in any order that names bones
/// before the hierarchy. Error kMalformed "name:line" naming section, bone and key: an unknown section, key, channel or
/// unit, a root without order, or with part of its translation or turn, a missing name or length, a direction of no
/// length for a bone that has one, dof and limits of different count, a bone twice, a bone that is not in the hierarchy
/// or hangs on itself. Source: Acclaim ASF/AMC as Vicon writes it.
Expected<Asf> ParseAsf(std::string_view bytes, const std::string& name);

/// From the start of a bone to its end in world axes at rest: the unit direction times the length, file units.
Vector3d AsfOffset(const AsfBone& bone);
/// The matrix of a rotation; `radians_per_unit` of its angles.
Matrix3d AcclaimMatrix(const AcclaimAxis& axis, double radians_per_unit);

/// "rx".
const char* Name(AcclaimChannel channel);

}  // namespace mocurate
