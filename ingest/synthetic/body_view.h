#pragma once

#include <vector>

#include "core/body/bone_capsules.h"
#include "ingest/synthetic/layout.h"

namespace mocurate {

/// Renders an actor's body for a depth camera: skin where there is a template, else capsules.
class BodyView {
 public:
  explicit BodyView(const Actor& actor);

  /// Metres along the camera's axis, 0 outside the body. `motion` is the actor's.
  std::vector<float> Depth(const Motion& motion, int frame, const Camera& camera,
                           const std::vector<Vector2d>& rays) const;

  /// Capsules around the bones in the world, for occlusion of joints.
  std::vector<PosedCapsule> Capsules(const Motion& motion, int frame) const;

 private:
  const Actor& actor_;
  CapsuleBody capsules_;
};

}  // namespace mocurate
