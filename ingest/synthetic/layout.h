#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/body/flesh_body.h"
#include "core/body/skinned_body.h"
#include "ingest/synthetic/performance.h"
#include "ingest/synthetic/studio_folder.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

/// Somebody with a body: on SMPL's 24 joints, with a skin where there is a template.
struct Actor {
  Subject subject;
  SkeletonPtr skeleton;  ///< "smpl24"; the actor's own rest offsets with a skin
  const BodyTemplate* body = nullptr;
  RestBody rest;  ///< of the template, in the actor's shape
};

/// People 1 .. count. With a template their bodies are its shapes, without one the skeleton's with other proportions.
/// Somebody's body does not depend on what is performed.
Expected<std::vector<Actor>> ActorsOf(const StudioOptions& options, std::int64_t count, const BodyTemplate* body);

/// The same motion at these frames only, moved by `target_from_world`. Rotation included; the rate stays.
Motion Seen(const Motion& motion, const std::vector<int>& frames, const RigidTransform& target_from_world);
/// All frames.
Motion Seen(const Motion& motion, const RigidTransform& target_from_world);

/// As a camera sees it whose clock is late by so many seconds: between two frames rotations by slerp, the root on a
/// line.
Motion Later(const Motion& motion, double seconds);

/// x right, y down, z forward from x right, y up, z back: half a turn about x, both ways the same.
RigidTransform HalfTurnAboutX();

/// sensor_from_world, canonical axes, of a sensor at the origin that looks along -z and `tilt` radians down.
RigidTransform LooksDown(double tilt);

/// (J*3) rotation vectors of a frame, root first.
std::vector<double> RotationVectors(const Motion& motion, int frame);

std::string Digits(int number, int width);

// One layout each: its files below the folder and the truth of its clips.
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
