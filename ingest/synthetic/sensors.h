#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/body/bone_capsules.h"
#include "core/formats/openpose.h"
#include "core/geometry/camera.h"
#include "core/motion/motion.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

/// Depth of an empty room: the floor y = 0 and a wall `wall` metres behind the origin at -z, from a camera; 0 where
/// neither is visible. Metres, (height*width).
std::vector<float> RoomDepth(const Camera& camera, const std::vector<Vector2d>& rays, double wall);

/// The sensor's measurement of a body before a background (empty: no background). Noise and quantisation grow with the
/// distance (Nguyen et al. 2012, Khoshelham 2012); edges have flying pixels; holes and surfaces at a grazing angle have
/// no value. Millimetres, 0 for no value. `item` keys the randomness.
DepthImage SimulateDepth(const std::vector<float>& body, const std::vector<float>& background, const Camera& camera,
                         const std::vector<Vector2d>& rays, const DepthSensorOptions& options, std::int64_t seed,
                         const std::string& item);

/// Left and right exchanged, as Kinects write their images.
DepthImage Mirrored(const DepthImage& image);

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

/// A true point in an image: its pixel, and whether the body occludes it. No pixel: outside the image or behind the
/// camera.
struct ImagePoint {
  std::optional<Vector2d> pixel;
  bool hidden = false;
};

/// For each point of a motion's frame, (F,K,3), whether the body's capsules occlude it from a camera. Surfaces up to
/// `own_surface` metres before a point are its own.
std::vector<bool> HiddenPoints(const Camera& camera, std::vector<PosedCapsule> capsules, const JointPositions& places,
                               int frame, double own_surface);

/// Points of a motion's frame, (F,K,3), in an image, hidden where the body's capsules occlude them.
std::vector<ImagePoint> PointsIn(const Camera& camera, const std::vector<PosedCapsule>& capsules,
                                 const JointPositions& places, int frame);

/// A detector's output for a person: points near the true ones, with lower confidence the larger the error. Some are
/// missed (0, 0, 0), some are at a wrong position with an uninformative confidence. Rounded as OpenPose writes them.
/// `item` keys the randomness.
OpenPosePerson Detected(const std::vector<ImagePoint>& points, const KeypointOptions& options, std::int64_t seed,
                        const std::string& item);

}  // namespace mocurate
