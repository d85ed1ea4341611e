#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/body/bone_capsules.h"
#include "core/motion/skeleton.h"

namespace mocurate {

/// A capsule that moves with the frame of one joint. It goes from that joint to `end_joint` (a child, or the joint
/// itself), both ends moved by offsets in the joint's frame: the body surface is not centred on bones and extends past
/// the last joints. Metres.
struct BodyCapsule {
  int frame = 0;
  int end_joint = 0;
  Vector3d begin_offset = Vector3d::Zero();
  Vector3d end_offset = Vector3d::Zero();
  double radius = 0.05;
  int mirror = 0;  ///< the capsule on the other side; its own index on the midline
};

/// A body of capsules with offsets from the bones: the model that is fitted to point clouds, and drawn.
struct CapsuleBody {
  SkeletonPtr skeleton;
  std::vector<BodyCapsule> capsules;

  /// One capsule per bone with the radius of its end; of a skeleton with SMPL's joints (HasTemplateShape) the capsules
  /// of the CC0 body template that its rest pose is taken from, several per limb, with the person's Skeleton::shape.
  /// Offsets and radii are scaled by `scale`.
  static CapsuleBody Make(SkeletonPtr skeleton, double scale);

  /// (J) joints that rotate a capsule.
  std::vector<bool> MovingJoints() const;
};

/// Ends of a capsule's axis in the world.
struct CapsuleEnds {
  Vector3d begin;
  Vector3d end;
};

/// `frame_joint` and `end_joint` are world positions of the joints that the capsule names.
CapsuleEnds EndsOf(const BodyCapsule& capsule, const Matrix3d& world_from_frame, const Vector3d& frame_joint,
                   const Vector3d& end_joint);

/// All capsules of a body in the world. `joints` and `world_from_joint` (J) as ForwardKinematics gives them.
std::vector<PosedCapsule> PosedCapsules(const CapsuleBody& body, const Vector3d* joints,
                                        const Quaterniond* world_from_joint);

/// Whether the skeleton has SMPL's joints, so that the CC0 template and Skeleton::shape define the body.
bool HasTemplateShape(const Skeleton& skeleton);

/// Radii of a body's capsules as text, metres to 0.1 mm, blank-separated, and the skeleton's body shape, if known, to
/// 0.001: stored in Clip::provenance of a fitted body (key kCapsuleRadii).
inline constexpr const char* kCapsuleRadii = "capsule_radii";
std::string RadiiText(const CapsuleBody& body);

/// The body of that text: Make at the scale of the bone lengths (J), with those radii and that shape. Empty for a text
/// that does not give one positive radius per capsule.
std::optional<CapsuleBody> BodyFromRadii(SkeletonPtr skeleton, const std::vector<double>& bone_length,
                                         const std::string& radii);

/// Sum of bone lengths (J) over that of the rest skeleton: how much larger the person is. 1 without lengths.
double BodyScale(const Skeleton& skeleton, const std::vector<double>& bone_length);

/// BodyShape is a person's difference from the CC0 template of the same size, in standard deviations of principal
/// components. The components are of capsule bodies of that template's variants (sexes, children, heavy, thin,
/// muscular, tall and short people), with size removed. 0: the template, the mean of man and woman.

/// Change of the rest offset of one of SMPL's joints, metres at the template's size. Zero for other names.
Vector3d OffsetChange(std::string_view joint, const BodyShape& shape);

/// Change of a capsule of the left side against the template's, metres at the template's size.
struct CapsuleChange {
  Vector3d begin = Vector3d::Zero();
  Vector3d end = Vector3d::Zero();
  double radius = 0.0;
};

/// Of the bones and of the other parts of CapsuleBody, in its order.
CapsuleChange ChangeOfBone(std::size_t bone, const BodyShape& shape);
CapsuleChange ChangeOfPart(std::size_t part, const BodyShape& shape);

}  // namespace mocurate
