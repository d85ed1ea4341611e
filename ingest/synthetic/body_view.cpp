#include "ingest/synthetic/body_view.h"

#include "core/body/mesh_depth.h"
#include "core/motion/kinematics.h"

namespace mocurate {

BodyView::BodyView(const Actor& actor)
    : actor_(actor),
      capsules_(CapsuleBody::Make(actor.skeleton, BodyScale(*actor.skeleton, actor.subject.bone_length), 1.0)) {}

std::vector<PosedCapsule> BodyView::Capsules(const Motion& motion, int frame) const {
  std::vector<Vector3d> joints(static_cast<std::size_t>(motion.joint_count()));
  std::vector<Quaterniond> global(joints.size());
  ForwardKinematics(*motion.skeleton, motion.root_translation[frame], &motion.rotation_at(frame, 0), motion.bone_length,
                    joints.data(), global.data());
  return PosedCapsules(capsules_, joints.data(), global.data());
}

std::vector<float> BodyView::Depth(const Motion& motion, int frame, const Camera& camera,
                                   const std::vector<Vector2d>& rays) const {
  if (actor_.body == nullptr) return RenderCapsules(Capsules(motion, frame), camera, rays).depth;
  std::vector<Quaterniond> rotations;
  for (int j = 0; j < motion.joint_count(); ++j) rotations.push_back(motion.rotation_at(frame, j));
  const Vector3d translation = motion.root_translation[frame] - actor_.rest.joints[0];
  const RestBody posed = Posed(*actor_.body, actor_.rest, rotations, translation);
  return RenderMesh(posed.vertices, actor_.body->faces, camera, rays);
}

}  // namespace mocurate
