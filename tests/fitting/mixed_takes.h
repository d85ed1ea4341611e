#pragma once

#include "ingest/synthetic/body_points.h"
#include "ingest/synthetic/sensors.h"
#include "tests/fitting/cloud_takes.h"

namespace mocurate {

/// Colour cameras in addition to the depth cameras of CloudTakes, and the errors of their detector.
struct MixedTakeOptions {
  RigOptions rig;             ///< own: a ring
  int views = 3;              ///< the first of the rig
  KeypointOptions keypoints;  ///< of BODY_25
  double later_s = 0.0;       ///< delay of the colour cameras behind the depth cameras
  RigidTransform world_off;   ///< true world to the colour cameras' world
};

/// Detects BODY_25 of a take's person in each camera; occluded points have lower confidence.
inline void AddKeypointViews(const MixedTakeOptions& options, const Actor& actor, std::int64_t seed, CloudTake& take) {
  const Motion delayed = DelayBy(take.clip.truth, options.later_s);
  const JointPositions places = PlacesOf(delayed, Body25Places());
  const BodyView body(actor);
  std::vector<Camera> rig = RigOf(options.rig, SensorKind::kColour);
  rig.resize(std::min<std::size_t>(rig.size(), static_cast<std::size_t>(options.views)));
  take.evidence.keypoint_names = NamesOf(Body25Places());
  take.evidence.keypoint_views.clear();
  for (const Camera& camera : rig) {
    KeypointView view;
    view.camera = camera;
    view.camera.camera_from_world = camera.camera_from_world * Inverse(options.world_off);
    view.people = 1;
    for (int f = 0; f < delayed.frame_count(); ++f) {
      view.time_s.push_back(delayed.rate.FrameTime(f));
      const std::string item = take.clip.name + "/" + camera.name + "/" + std::to_string(f);
      const OpenPosePerson person =
          Detected(PointsIn(camera, body.Capsules(delayed, f), places, f), options.keypoints, seed, item);
      for (const DetectedKeypoint& point : person.pose) {
        view.values.insert(view.values.end(), {point.u_px, point.v_px, point.detected() ? point.confidence : 0.0});
      }
    }
    take.evidence.keypoint_views.push_back(std::move(view));
  }
}

/// The actors of CloudTakes; `body` outlives them.
inline std::vector<Actor> ActorsOfTakes(const CloudTakeOptions& options, const BodyTemplate& body) {
  StudioOptions studio;
  studio.seed = static_cast<std::int64_t>(options.seed);
  return *ActorsOf(studio, options.subjects, &body);
}

}  // namespace mocurate
