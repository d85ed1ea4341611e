#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/body/capsule_body.h"
#include "core/body/skinned_body.h"
#include "ingest/synthetic/performance.h"
#include "ingest/synthetic/studio_folder.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

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

/// (J*3) rotation vectors of a frame, root first.
std::vector<double> RotationVectors(const Motion& motion, int frame);

std::string Digits(int number, int width);

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
