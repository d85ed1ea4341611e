#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/rotation.h"

namespace mocurate {

/// Which angles a joint's rotation vector may take, radians, in the frame of the rest pose.
struct JointLimits {
  Vector3d min = Vector3d::Constant(-3.14159265358979);
  Vector3d max = Vector3d::Constant(3.14159265358979);
};

/// The axis about which a joint bends farther than a right angle one way and half a radian at most the other, as knees
/// and elbows do; empty: it is not a hinge.
std::optional<int> HingeAxis(const JointLimits& limits);

struct Joint {
  std::string name;  ///< the skeleton's own name, e.g. "left_knee"
  int parent = -1;   ///< index below its own; -1 for the root only
  Vector3d rest_offset =
      Vector3d::Zero();               ///< from the parent in the rest pose, metres, canonical axes (y up, +z front)
  int mirror = -1;                    ///< partner on the other side; its own index for joints on the midline
  std::vector<std::string> synonyms;  ///< other names of the same joint, compared without case, blanks, '_' and '-'
  std::optional<JointLimits> limits;
  double radius = 0.05;   ///< capsule of the bone that ends here, metres
  bool landmark = false;  ///< a surface point kept as a joint (ntu18): its own rotation stays the identity
  /// Frame of the mirror partner from this joint's frame in a mirror image (orthogonal, determinant -1); absent: found
  /// from the rest offsets, x -> -x for a symmetric T-pose.
  std::optional<Matrix3d> reflection;
};

/// A point that is not a joint of the tree (nose, heel, head top of NTU-18): fixed in the frame of a joint.
struct Landmark {
  std::string name;
  int joint = 0;
  Vector3d offset = Vector3d::Zero();  ///< in the joint's frame, rest pose, metres
};

/// Action2Motion's kinematics: chains of joints that each restart from the identity, with integer raw offsets.
struct LieChains {
  std::vector<std::vector<int>> chains;
  std::vector<Vector3d> raw_offsets;  ///< unit vector per joint; zero for the root
};

/// Difference of a person's body shape from the mean of the same size, in standard deviations among people
/// (`core/body/capsule_body.h`).
inline constexpr int kShapeComponents = 5;
using BodyShape = std::array<double, kShapeComponents>;

/// A named tree of joints. Joint 0 is the root; parents precede children.
struct Skeleton {
  std::string name;
  std::vector<Joint> joints;
  std::vector<Landmark> landmarks;
  std::optional<LieChains> lie;
  BodyShape shape{};  ///< of the person whose skeleton it is; all 0: not known

  int joint_count() const { return static_cast<int>(joints.size()); }
  /// By name or synonym; empty when there is none.
  std::optional<int> FindJoint(std::string_view name) const;
  std::vector<std::vector<int>> Children() const;
  /// Length of the bone that ends at each joint in the rest pose; 0 for the root. (J), metres.
  std::vector<double> RestBoneLengths() const;
  /// Joints whose direction defines left and right: (left, right) hip, else (left, right) shoulder.
  std::optional<std::array<int, 2>> Hips() const;
  std::optional<std::array<int, 2>> Shoulders() const;
  /// Joint::reflection where it is given, else the signed diagonal that best takes the directions to the children to
  /// those of the partner's children; turned by the smallest rotation that makes it exact for a single child.
  Matrix3d Reflection(int joint) const;

  /// The parent along the Lie chains, -1 for the root. Requires lie.
  std::vector<int> LieParents() const;

  /// Every rule the fields must keep (order of parents, mirror is an involution, unique names, chains cover the tree).
  Status Check() const;
};

using SkeletonPtr = std::shared_ptr<const Skeleton>;

/// Whether two skeletons have the same joint names and parents.
bool SameTree(const Skeleton& a, const Skeleton& b);
/// Whether two skeletons of one tree have the same rest offsets.
bool SameRestOffsets(const Skeleton& a, const Skeleton& b);
/// Largest angle between the rest poses of two skeletons of the same tree at a joint, radians: rotations are relative
/// to the rest pose. Of a single bone: the angle between its
/// directions. Of several bones at a joint: the part of their root mean square deviation that
/// the best common rotation removes.
double RestPosesApart(const Skeleton& a, const Skeleton& b);
/// Below this angle two rest poses count as equal, radians.
inline constexpr double kSameRestPose = 5e-3;
/// `skeleton` with the rest offsets of another of the same tree.
SkeletonPtr WithRestOffsetsOf(const Skeleton& skeleton, const Skeleton& other);

/// A skeleton of configs/skeletons/ by name ("smpl24", "humanact12", "ntu25", "ntu18", "cmu20", "cmu31", "kinect20",
/// "openni15", "openni16", "bandai22", "a2m21", "ntu14"), or a YAML file by path. Needs yaml (defined in
/// skeleton_yaml.cpp, target mocurate_motion_yaml).
Expected<SkeletonPtr> LoadSkeleton(const std::string& name_or_path);
/// From YAML text; `name` is shown in messages.
Expected<SkeletonPtr> ParseSkeleton(const std::string& yaml, const std::string& name);

/// Position on a body of a point that a tracker lists as a joint: fixed to a joint of the body, with a standard
/// deviation. A tracker's "neck" may lie between the shoulders.
struct PointPlace {
  std::string point;                   ///< joint of the tracker's skeleton
  std::string joint;                   ///< joint of the body (names of smpl24) that the point moves with
  Vector3d offset = Vector3d::Zero();  ///< in that joint's frame, rest pose, metres
  double spread = 0.0;                 ///< standard deviation per axis, metres: of people, clothes and the tracker
};

/// `on_body` of a skeleton of LoadSkeleton, in its order; empty for one whose joints are those of a body. Needs yaml.
Expected<std::vector<PointPlace>> LoadPointPlaces(const std::string& name_or_path);

/// Names of one skeleton's joints without the exporter's common prefix: "mixamorig:Hips", "mixamorigHips",
/// "Character1_Hips", "Armature|Hips" and "Bip01 L Thigh" become "Hips" and "L Thigh". Everything before the last ':'
/// or '|' is removed. Then the common prefix of all names but the root's, and of at least 5, is removed, up to a
/// separator or to a capital letter in every name. No name becomes empty, and different names stay different.
std::vector<std::string> WithoutNamespace(std::vector<std::string> names);

/// The same names where the skeleton knows each of them, else without their namespace.
std::vector<std::string> NamesIn(const Skeleton& skeleton, const std::vector<std::string>& names);

}  // namespace mocurate
