#include "report/posed_body.h"

#include "core/body/capsule_body.h"
#include "core/motion/kinematics.h"
#include "report/filmstrip.h"

namespace mocurate {
namespace {

/// A fitted body in a frame of its motion: two points of its own for each capsule.
PosedBody PoseOf(const CapsuleBody& body, const Motion& motion, int frame, const std::vector<int>& sides) {
  std::vector<Vector3d> joints(motion.joint_count());
  std::vector<Quaterniond> turns(motion.joint_count());
  ForwardKinematics(*motion.skeleton, motion.root_translation[frame], &motion.rotation_at(frame, 0), motion.bone_length,
                    joints.data(), turns.data());
  PosedBody posed;
  posed.capsules.skeleton = motion.skeleton;
  for (const BodyCapsule& capsule : body.capsules) {
    const CapsuleEnds ends =
        EndsOf(capsule, turns[capsule.frame].toRotationMatrix(), joints[capsule.frame], joints[capsule.end_joint]);
    const auto first = static_cast<int>(posed.points.size());
    posed.points.insert(posed.points.end(), {ends.begin, ends.end});
    posed.capsules.capsules.push_back({first + 1, first, capsule.radius});
    posed.sides.push_back(sides[capsule.end_joint]);
  }
  return posed;
}

}  // namespace

PosedBody BodyOf(const Clip& clip, int frame) {
  const Motion& motion = *clip.motion;
  const std::vector<int> sides = SidesOf(*motion.skeleton);
  const auto radii = clip.provenance.find(kCapsuleRadii);
  if (radii != clip.provenance.end() && !motion.joints_only()) {
    if (const auto body = BodyFromRadii(motion.skeleton, motion.bone_length, radii->second)) {
      return PoseOf(*body, motion, frame, sides);
    }
  }
  PosedBody posed;
  posed.capsules = BoneCapsules::Make(motion.skeleton, BodyScale(*motion.skeleton, motion.bone_length));
  for (int j = 0; j < motion.joint_count(); ++j) posed.points.emplace_back(motion.joints.at(frame, j));
  for (const Capsule& capsule : posed.capsules.capsules) posed.sides.push_back(sides[capsule.joint]);
  return posed;
}

}  // namespace mocurate
