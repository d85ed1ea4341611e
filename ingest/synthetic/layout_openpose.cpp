#include <nlohmann/json.hpp>

#include "core/base/random.h"
#include "ingest/synthetic/action_parts.h"
#include "ingest/synthetic/body_points.h"
#include "ingest/synthetic/body_view.h"
#include "ingest/synthetic/humanact12_set.h"
#include "ingest/synthetic/keypoint_detector.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/rigs.h"
#include "ingest/synthetic/take_plan.h"

namespace mocurate {
namespace {

constexpr std::int64_t kRateHz = 30;
constexpr double kOwnFlesh = 0.14;  // metres in front of a point that belong to it

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

std::vector<ImagePoint> PointsIn(const Camera& camera, const std::vector<PosedCapsule>& flesh,
                                 const JointPositions& places, int frame) {
  std::vector<PosedCapsule> in_camera;
  for (const PosedCapsule& capsule : flesh) {
    in_camera.push_back(
        {camera.camera_from_world * capsule.begin, camera.camera_from_world * capsule.end, capsule.radius});
  }
  std::vector<ImagePoint> points;
  for (int k = 0; k < places.joints; ++k) {
    const Vector3d at = camera.camera_from_world * places.at(frame, k);
    ImagePoint point;
    point.pixel = camera.Project(at);
    const auto inside = [](double value, int size) { return value >= 0.0 && value <= size - 1.0; };
    if (point.pixel && !(inside(point.pixel->x(), camera.width) && inside(point.pixel->y(), camera.height))) {
      point.pixel.reset();
    }
    point.hidden = FirstEntry(in_camera, at) < 1.0 - kOwnFlesh / at.norm();
    points.push_back(point);
  }
  return points;
}

/// What one camera's detector says of a take, frame by frame.
Status WriteView(const StudioOptions& options, const Actor& actor, const Motion& motion, const Camera& camera,
                 const std::string& take, StudioFolder& folder) {
  const BodyView body(actor);
  const JointPositions places = PlacesOf(motion, Body25Places());
  // Somebody else stands behind the subject all the time and is found now and then.
  const Motion other = Seen(motion, std::vector<int>(1, 0), {Quaterniond::Identity(), Vector3d(1.1, 0.0, -1.2)});
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
        "openpose/" + take + "/" + camera.name + "_json/" + camera.name + "." + Digits(f, 4) + ".json";
    if (Status written = folder.Write(name, WriteOpenPose(frame)); !written) return written;
  }
  return {};
}

}  // namespace

Status WriteOpenPoseLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const std::vector<SetClass> classes = Classes();
  const auto takes = PlanTakes(options, classes, {2, 1, static_cast<double>(kRateHz), 0.3, 0.6});
  if (!takes) return Forward(takes);
  const std::vector<Camera> rig = RigOf(options.rig, SensorKind::kColour);
  const RigFaults faults = FaultsOf(options.rig, rig, options.seed);
  Status calibrated = folder.Write("openpose/calib.json", CalibrationText(rig));
  if (!calibrated) return calibrated;
  return folder.ForEach(takes->size() * rig.size(), [&](std::size_t i) -> Status {
    const PlannedTake& take = (*takes)[i / rig.size()];
    const std::size_t view = i % rig.size();
    const Actor& actor = actors[static_cast<std::size_t>(take.subject - 1)];
    const std::string person = "p" + Digits(take.subject, 2);
    const std::string name = std::string(take.kind->label) + "_" + person + "_r" + Digits(take.repetition, 2);
    const Motion motion = PerformScript(take.script, actor.subject, actor.skeleton, FrameRate{kRateHz, 1});
    if (view == 0) {
      ClipIdentity identity;
      identity.source = "openpose";
      identity.person = person;
      identity.recording = name;
      identity.end_frame = motion.frame_count();
      folder.AddTruth(person, identity.id(), motion);
    }
    return WriteView(options, actor, Later(motion, faults.clock_s[view]), faults.real[view], name, folder);
  });
}

}  // namespace mocurate
