#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/body/capsule_body.h"
#include "core/body/skinned_body.h"
#include "core/geometry/camera.h"
#include "ingest/synthetic/performance.h"
#include "ingest/synthetic/studio_folder.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

struct VibeTrack;

/// A person with a body: on SMPL's 24 joints, with a skin where there is a template.
struct Actor {
  Subject subject;
  SkeletonPtr skeleton;  ///< "smpl24"; the actor's own rest offsets with a skin
  const BodyTemplate* body = nullptr;
  RestBody rest;  ///< of the template, in the actor's shape
};

/// People 1 .. count. With a template their bodies are its shapes, without one the skeleton's with other proportions. A
/// person's body does not depend on the actions.
Expected<std::vector<Actor>> ActorsOf(const StudioOptions& options, std::int64_t count, const BodyTemplate* body);

/// The motion at these frames only, transformed by `target_from_world`, rotations included; the rate stays.
Motion SelectFrames(const Motion& motion, const std::vector<int>& frames, const RigidTransform& target_from_world);
/// All frames.
Motion SelectFrames(const Motion& motion, const RigidTransform& target_from_world);

/// The motion as recorded by a camera with this clock offset in seconds: rotations by slerp between frames, the root
/// linearly.
Motion DelayBy(const Motion& motion, double seconds);

/// x right, y down, z forward from x right, y up, z back: half a rotation about x, its own inverse.
RigidTransform HalfRotationAboutX();

/// sensor_from_world, canonical axes, of a sensor at the origin that looks along -z and `tilt` radians down.
RigidTransform LooksDown(double tilt);

/// Rounded to significant digits, as sensors write their numbers.
double RoundedToDigits(double value, int digits);

/// (J*3) rotation vectors of a frame, root first.
std::vector<double> RotationVectors(const Motion& motion, int frame);

/// VIBE's output for a person in an image with focal length 500: rotations, 49 points around the pelvis, and
/// weak-perspective cameras of 540 x 540 pixels, for which z = 500 / (270 sx). `motion` is in the camera's axes (x
/// right, y down, z forward), boxes are around `image_centre` (pixels). Points have the errors of the options; a
/// missing point is extrapolated from its last position, and exchanged limbs affect the points only. Noise, bias and
/// wander, taken as displacements of the end of a 0.25 m limb, give the rotation errors; the root's position has the
/// same error, four times along the line of sight.
VibeTrack VibeTrackOf(const Motion& motion, const TrackerOptions& options, std::int64_t seed, const std::string& item,
                      const Vector2d& image_centre = {270.0, 270.0});

/// Writes every `options.depth.every`-th frame of an actor's motion as a depth camera's image, file `name_of(frame)`.
/// `item` and the frame key the randomness; `background`: RoomDepth, empty for an image of the person alone;
/// `mirrored`: left and right exchanged, as Kinects write their images.
Status WriteDepthImages(const StudioOptions& options, const Actor& actor, const Motion& motion, const Camera& camera,
                        const std::string& item, const std::vector<float>& background, bool mirrored,
                        const std::function<std::string(int)>& name_of, StudioFolder& folder);

// One function per layout: it writes the files below the folder and the truth of its clips.
Status WriteHumanAct12Layout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder);
Status WritePhspdLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder);
Status WriteNtuLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder);
Status WriteKardLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder);
Status WriteUestcLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder);
Status WriteUestcVibeLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder);
Status WriteNtuVibeLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder);
Status WriteTracksLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder);
Status WriteOpenPoseLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder);
Status WriteOpenPoseDepthLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder);
Status WriteDepthSequenceLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder);
Status WriteCmu8Layout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder);
Status WriteAmassLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder);

}  // namespace mocurate
