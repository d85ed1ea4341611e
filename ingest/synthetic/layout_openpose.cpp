#include <nlohmann/json.hpp>

#include "core/base/random.h"
#include "core/base/text.h"
#include "ingest/synthetic/body_points.h"
#include "ingest/synthetic/humanact12_set.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/rigs.h"
#include "ingest/synthetic/sensors.h"
#include "ingest/synthetic/take_plan.h"

namespace mocurate {
namespace {

/// Cameras as plain JSON: world-to-camera in metres, the studio's world.
std::string CalibrationText(const std::vector<Camera>& cameras) {
  nlohmann::json document = {{"units", "metre"}, {"convention", "x_cam = R X_world + t, x right, y down, z forward"}};
  for (const Camera& camera : cameras) {
    const Matrix3d r = camera.camera_from_world.rotation.toRotationMatrix();
    const Vector3d t = camera.camera_from_world.translation;
    const LensDistortion& lens = camera.distortion;
    document["cameras"].push_back(
        {{"name", camera.name},
         {"size", {camera.width, camera.height}},
         {"K", {{camera.fx, 0.0, camera.cx}, {0.0, camera.fy, camera.cy}, {0.0, 0.0, 1.0}}},
         {"dist_k1k2p1p2k3", {lens.k1, lens.k2, lens.p1, lens.p2, lens.k3}},
         {"R", {{r(0, 0), r(0, 1), r(0, 2)}, {r(1, 0), r(1, 1), r(1, 2)}, {r(2, 0), r(2, 1), r(2, 2)}}},
         {"t", {t.x(), t.y(), t.z()}}});
  }
  return document.dump(1) + "\n";
}

std::vector<SetClass> Classes() {
  std::vector<SetClass> classes;
  int id = 0;
  for (const std::string& action : KnownActions()) {
    for (const HumanAct12Variant& variant : HumanAct12Variants()) {
      if (action == variant.action) classes.push_back({++id, variant.action, variant.action, variant.seated});
    }
  }
  return classes;
}

/// One camera's detections of a take, frame by frame; `take` is its folder.
Status WriteKeypoints(const StudioOptions& options, const Actor& actor, const Motion& motion, const Camera& camera,
                      const std::string& folder_name, const std::string& take, StudioFolder& folder) {
  const BodyView body(actor);
  const JointPositions places = PlacesOf(motion, Body25Places());
  // A bystander stands behind the subject all the time and is detected in some frames.
  const Motion other =
      SelectFrames(motion, std::vector<int>(1, 0), {Quaterniond::Identity(), Vector3d(1.1, 0.0, -1.2)});
  const JointPositions other_places = PlacesOf(other, Body25Places());
  for (int f = 0; f < motion.frame_count(); ++f) {
    const std::string item = take + "/" + camera.name + "/" + std::to_string(f);
    OpenPoseFrame frame;
    frame.people.push_back(
        Detected(PointsIn(camera, body.Capsules(motion, f), places, f), options.keypoints, options.seed, item));
    Random random(static_cast<std::uint64_t>(options.seed), "studio.bystander", item);
    if (random.Uniform() < options.keypoints.bystander_share) {
      frame.people.push_back(
          Detected(PointsIn(camera, {}, other_places, 0), options.keypoints, options.seed, item + "/bystander"));
    }
    const std::string name =
        folder_name + "/" + take + "/" + camera.name + "_json/" + camera.name + "." + ZeroPadded(f, 4) + ".json";
    if (Status written = folder.Write(name, WriteOpenPose(frame)); !written) return written;
  }
  return {};
}

/// Takes for the colour cameras, and the depth cameras where there are any; one calibration of all.
Status WriteTakes(const StudioOptions& options, const std::vector<Actor>& actors, const std::string& source,
                  const std::vector<Camera>& depth, StudioFolder& folder) {
  const Expected<std::vector<PlannedTake>> takes = PlanVariantTakes(options);
  if (!takes) return Forward(takes);
  std::vector<Camera> rig = RigOf(options.rig, SensorKind::kColour);
  const std::size_t colour = rig.size();
  rig.insert(rig.end(), depth.begin(), depth.end());
  const RigFaults faults = FaultsOf(options.rig, rig, options.seed);
  Status calibrated = folder.Write(source + "/calib.json", CalibrationText(rig));
  if (!calibrated) return calibrated;
  return folder.ForEach(takes->size() * rig.size(), [&](std::size_t i) -> Status {
    const PlannedTake& take = (*takes)[i / rig.size()];
    const std::size_t view = i % rig.size();
    const Actor& actor = actors[static_cast<std::size_t>(take.subject - 1)];
    const std::string person = "p" + ZeroPadded(take.subject, 2);
    const std::string name = std::string(take.kind->label) + "_" + person + "_r" + ZeroPadded(take.repetition, 2);
    const Motion motion = PerformScript(take.script, actor.subject, actor.skeleton, FrameRate{kVariantRateHz, 1});
    if (view == 0) folder.AddTruth(person, source + "/" + person + "/" + name, motion);
    const Motion seen = DelayBy(motion, faults.clock_s[view]);
    const Camera& camera = faults.real[view];
    if (view < colour) return WriteKeypoints(options, actor, seen, camera, source, name, folder);
    const auto name_of = [&](int f) {
      return source + "/" + name + "/depth/" + camera.name + "_" + ZeroPadded(f, 4) + ".png";
    };
    return WriteDepthImages(options, actor, seen, camera, name + "/" + camera.name, {}, false, name_of, folder);
  });
}

}  // namespace

Expected<std::vector<PlannedTake>> PlanVariantTakes(const StudioOptions& options) {
  static const std::vector<SetClass> classes = Classes();
  return PlanTakes(options, classes, {2, 1, static_cast<double>(kVariantRateHz), 0.3, 0.6});
}

Status WriteOpenPoseLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  return WriteTakes(options, actors, "openpose", {}, folder);
}

Status WriteOpenPoseDepthLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const std::vector<Camera> depth = RigOf({}, SensorKind::kDepth);
  return WriteTakes(options, actors, "openpose_depth", options.depth.enabled ? depth : std::vector<Camera>(), folder);
}

}  // namespace mocurate
