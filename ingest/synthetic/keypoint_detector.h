#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/body/capsule_body.h"
#include "core/formats/openpose.h"
#include "core/geometry/camera.h"
#include "core/motion/motion.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

/// A true point in an image: where it falls, and whether flesh hides it. No pixel: outside the image or behind it.
struct ImagePoint {
  std::optional<Vector2d> pixel;
  bool hidden = false;
};

/// Points of a motion's frame, (F,K,3), in an image, hidden where flesh lies in front of them.
std::vector<ImagePoint> PointsIn(const Camera& camera, const std::vector<PosedCapsule>& flesh,
                                 const JointPositions& places, int frame);

/// What a detector says of a person: points near the true ones, the less sure the farther off, some missed (0, 0, 0),
/// some in another place with a confidence that does not tell. Rounded as OpenPose writes them. `item` keys the
/// randomness.
OpenPosePerson Detected(const std::vector<ImagePoint>& points, const KeypointOptions& options, std::int64_t seed,
                        const std::string& item);

}  // namespace mocurate
