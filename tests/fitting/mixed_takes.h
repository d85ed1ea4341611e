#pragma once

#include "ingest/synthetic/body_points.h"
#include "ingest/synthetic/keypoint_detector.h"
#include "tests/fitting/cloud_takes.h"

namespace mocurate {

/// Colour cameras beside the depth cameras of CloudTakes, and how their detector errs.
struct MixedTakeOptions {
  RigOptions rig;             ///< own: a ring
  int views = 3;              ///< of the rig, from its first on
  KeypointOptions keypoints;  ///< of BODY_25
  double later_s = 0.0;       ///< the colour cameras see everything so much later than the depth cameras
  RigidTransform world_off;   ///< their world from the true one
};

/// BODY_25 of a take's person in each camera, hidden points found less surely.
inline void AddKeypointViews(const MixedTakeOptions& options, const Actor& actor, std::int64_t seed, CloudTake& take) {
  const Motion seen = Later(take.clip.truth, options.later_s);
  const JointPositions places = PlacesOf(seen, Body25Places());
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
    for (int f = 0; f < seen.frame_count(); ++f) {
      view.time_s.push_back(seen.rate.FrameTime(f));
      const std::string item = take.clip.name + "/" + camera.name + "/" + std::to_string(f);
      const OpenPosePerson person =
          Detected(PointsIn(camera, body.Capsules(seen, f), places, f), options.keypoints, seed, item);
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
