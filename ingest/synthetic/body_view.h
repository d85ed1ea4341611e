#pragma once

#include <vector>

#include "core/body/capsule_body.h"
#include "ingest/synthetic/layout.h"

namespace mocurate {

/// An actor's body as a depth camera sees it: skin where there is a template, else capsules.
class BodyView {
 public:
  explicit BodyView(const Actor& actor);

  /// Metres along the camera's axis, 0 where the body is not seen. `motion` is the actor's.
  std::vector<float> Depth(const Motion& motion, int frame, const Camera& camera,
                           const std::vector<Vector2d>& rays) const;

  /// Flesh around the bones in the world: what hides a joint.
  std::vector<PosedCapsule> Capsules(const Motion& motion, int frame) const;

 private:
  const Actor& actor_;
  FleshBody flesh_;
};

}  // namespace mocurate
