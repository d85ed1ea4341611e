#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/body/bone_capsules.h"
#include "core/formats/openpose.h"
#include "core/geometry/camera.h"
#include "core/motion/motion.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

/// A true point in an image: its pixel, and whether the body occludes it. No pixel: outside the image or behind the
/// camera.
struct ImagePoint {
  std::optional<Vector2d> pixel;
  bool hidden = false;
};

/// Points of a motion's frame, (F,K,3), in an image, hidden where the body's capsules occlude them.
std::vector<ImagePoint> PointsIn(const Camera& camera, const std::vector<PosedCapsule>& capsules,
                                 const JointPositions& places, int frame);

/// A detector's output for a person: points near the true ones, with lower confidence the larger the error. Some are
/// missed (0, 0, 0), some are at a wrong position with an uninformative confidence. Rounded as OpenPose writes them.
/// `item` keys the randomness.
OpenPosePerson Detected(const std::vector<ImagePoint>& points, const KeypointOptions& options, std::int64_t seed,
                        const std::string& item);

}  // namespace mocurate
