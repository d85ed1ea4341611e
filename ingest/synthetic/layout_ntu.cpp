#include <algorithm>

#include "core/base/random.h"
#include "core/base/text.h"
#include "core/body/capsule_body.h"
#include "core/formats/ntu_skeleton.h"
#include "core/motion/kinematics.h"
#include "ingest/synthetic/body_points.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/rigs.h"
#include "ingest/synthetic/sensors.h"
#include "ingest/synthetic/take_plan.h"
#include "ingest/synthetic/tracker.h"

namespace mocurate {
namespace {

constexpr std::int64_t kNtuRateHz = 30;
constexpr std::uint64_t kFirstBody = 72057594037927936u;  // first id of the sensor
constexpr double kColourFocal = 1050.0;
constexpr double kOwnSurface = 0.16;    // metres in front of a joint that count as its own surface
constexpr double kColourShift = 0.052;  // metres from the depth to the colour camera
/// Random stream of the false tracks. Another name would give other recordings for every seed.
constexpr const char* kFalseTrackStream = "studio.ghost";

/// One of the three sensors of a set-up: at -45, 0 and 45 degrees, all at one height.
Camera SensorOf(std::int64_t seed, int camera) {
  Random random(static_cast<std::uint64_t>(seed), "studio.setup");
  RigOptions ring;
  ring.cameras = 8;
  ring.radius = random.Uniform(2.8, 3.6);
  ring.height = random.Uniform(0.9, 1.5);
  // Camera 1 looks from 45 degrees, 2 and 3 from the front and the side of a person facing them.
  const std::array<std::size_t, 3> place = {0, 7, 1};
  Camera sensor = RingRig(ring, SensorKind::kDepth)[place[static_cast<std::size_t>(camera - 1)]];
  sensor.name = "C" + ZeroPadded(camera, 3);
  return sensor;
}

/// A point of the camera's frame in the sensor's: x to its left, y up, z away. Its images are mirrored likewise.
Vector3d InSensor(const Vector3d& in_camera) { return {-in_camera.x(), -in_camera.y(), in_camera.z()}; }

void PutPixels(const Camera& camera, NtuJoint& joint) {
  if (joint.z_m <= 0.0) return;
  joint.depth_u = camera.cx + camera.fx * joint.x_m / joint.z_m;
  joint.depth_v = camera.cy - camera.fy * joint.y_m / joint.z_m;
  joint.colour_u = 959.5 + kColourFocal * (joint.x_m + kColourShift) / joint.z_m;
  joint.colour_v = 539.5 - kColourFocal * joint.y_m / joint.z_m;
}

bool IsLeaf(int k) { return k == 3 || k == 15 || k == 19 || k >= 21; }

struct View {
  const PlannedTake* take = nullptr;
  int camera = 1;
  NtuName name;
};

NtuBody BodyAt(const View& view, const Motion& motion, const TrackedTake& tracked, const std::vector<bool>& hidden,
               const Camera& camera, int frame) {
  NtuBody body;
  body.id = kFirstBody + static_cast<std::uint64_t>(view.take->subject) * 64 + 1;
  std::vector<Vector3d> joints(static_cast<std::size_t>(motion.joint_count()));
  std::vector<Quaterniond> global(joints.size());
  ForwardKinematics(*motion.skeleton, motion.root_translation[frame], &motion.rotation_at(frame, 0), motion.bone_length,
                    joints.data(), global.data());
  const Quaterniond sensor_from_camera(0.0, 0.0, 0.0, 1.0);
  for (int k = 0; k < kNtuJoints; ++k) {
    NtuJoint& joint = body.joints[static_cast<std::size_t>(k)];
    const std::size_t sample = static_cast<std::size_t>(frame) * kNtuJoints + k;
    const Vector3d at = InSensor(camera.camera_from_world * tracked.positions.at(frame, k));
    joint.x_m = at.x(), joint.y_m = at.y(), joint.z_m = at.z();
    PutPixels(camera, joint);
    joint.tracking = tracked.seen[sample] == 0 || hidden[static_cast<std::size_t>(k)] ? 1 : 2;
    if (IsLeaf(k)) continue;
    const int own = motion.skeleton->FindJoint(Kinect25Places()[static_cast<std::size_t>(k)].joint).value_or(0);
    const Quaterniond rotation = (sensor_from_camera * camera.camera_from_world.rotation * global[own]).normalized();
    joint.qw = rotation.w(), joint.qx = rotation.x(), joint.qy = rotation.y(), joint.qz = rotation.z();
  }
  return body;
}

/// Float32 in seven digits, as the sensor writes its numbers.
void RoundAll(NtuBody& body) {
  for (NtuJoint& joint : body.joints) {
    for (double* value : {&joint.x_m, &joint.y_m, &joint.z_m, &joint.depth_u, &joint.depth_v, &joint.colour_u,
                          &joint.colour_v, &joint.qw, &joint.qx, &joint.qy, &joint.qz}) {
      *value = RoundedToDigits(*value, 7);
    }
  }
}

/// A false track: furniture that the sensor took for a person; hardly moves, appears and disappears.
void AddFalseTrack(const StudioOptions& options, const std::string& item, const Camera& camera, NtuSkeleton& skeleton) {
  Random random(static_cast<std::uint64_t>(options.seed), kFalseTrackStream, item);
  if (random.Uniform() >= options.false_track_share || skeleton.frames.empty()) return;
  NtuBody false_track = skeleton.frames.front().front();
  false_track.id = kFirstBody + 60000 + random.Below(1000);
  const double side = random.Uniform() < 0.5 ? -1.0 : 1.0;
  const Vector3d away(side * random.Uniform(0.9, 1.4), random.Uniform(-0.4, 0.1), random.Uniform(0.3, 0.8));
  for (NtuJoint& joint : false_track.joints) {
    joint.x_m += away.x() + random.Uniform(-0.08, 0.08);
    joint.y_m = 0.6 * joint.y_m + away.y() + random.Uniform(-0.08, 0.08);
    joint.z_m += away.z() + random.Uniform(-0.08, 0.08);
    joint.tracking = 1;
  }
  const std::size_t count = skeleton.frames.size();
  const std::size_t begin = random.Below(std::max<std::size_t>(1, count / 2));
  const std::size_t end = begin + 1 + random.Below(count - begin);
  for (std::size_t f = begin; f < std::min(end, count); ++f) {
    NtuBody body = false_track;
    for (NtuJoint& joint : body.joints) {
      joint.x_m += 0.002 * random.Normal();
      joint.y_m += 0.002 * random.Normal();
      joint.z_m += 0.003 * random.Normal();
      PutPixels(camera, joint);
    }
    RoundAll(body);
    skeleton.frames[f].push_back(body);
  }
}

}  // namespace

Status WriteNtuLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const auto takes = PlanNtuTakes(options);
  if (!takes) return Forward(takes);
  std::vector<Camera> calibrated;
  for (int camera = 1; camera <= 3; ++camera) calibrated.push_back(SensorOf(options.seed, camera));
  const RigFaults faults = FaultsOf(options.rig, calibrated, options.seed);
  std::vector<View> views;
  for (const PlannedTake& take : *takes) {
    for (int camera = 1; camera <= 3; ++camera) {
      views.push_back(
          {&take, camera, {FirstSetupOf(take.kind->id), camera, take.subject, take.repetition, take.kind->id}});
    }
  }
  return folder.ForEach(views.size(), [&](std::size_t i) -> Status {
    const View& view = views[i];
    const auto sensor = static_cast<std::size_t>(view.camera - 1);
    const Camera& camera = faults.real[sensor];
    const Actor& actor = actors[static_cast<std::size_t>(view.take->subject - 1)];
    Script script = view.take->script;
    // The first repetition faces camera 2, the second camera 3.
    script.heading += view.take->repetition % 2 == 1 ? -0.25 * kPi : 0.25 * kPi;
    const Motion motion =
        DelayBy(PerformScript(script, actor.subject, actor.skeleton, FrameRate{kNtuRateHz, 1}), faults.clock_s[sensor]);
    const std::string recording = view.name.Text();
    const BodyView body(actor);
    const JointPositions places = PlacesOf(motion, Kinect25Places());
    TrackedTake tracked = Track(places, NamesOf(Kinect25Places()), options.tracker, options.seed, recording);
    ExtrapolateMissing(options.tracker, options.seed, recording, tracked);
    NtuSkeleton skeleton;
    for (int f = 0; f < motion.frame_count(); ++f) {
      const std::vector<bool> hidden = HiddenPoints(camera, body.Capsules(motion, f), places, f, kOwnSurface);
      NtuBody at = BodyAt(view, motion, tracked, hidden, camera, f);
      RoundAll(at);
      skeleton.frames.push_back({at});
    }
    AddFalseTrack(options, recording, camera, skeleton);
    Status written = folder.Write("nturgb+d_skeletons/" + recording + ".skeleton", WriteNtuSkeleton(skeleton));
    if (!written) return written;
    const std::string person = "P" + ZeroPadded(view.take->subject, 3);
    folder.AddTruth(person, "ntu/" + person + "/" + recording,
                    SelectFrames(motion, HalfRotationAboutX() * camera.camera_from_world));
    if (!options.depth.enabled) return {};
    // Mirrored as the sensor's images are, 0 outside the body.
    const auto name_of = [&](int f) {
      return "nturgb+d_depth_masked/" + recording + "/MDepth-" + ZeroPadded(f + 1, 8) + ".png";
    };
    return WriteDepthImages(options, actor, motion, camera, recording, {}, true, name_of, folder);
  });
}

}  // namespace mocurate
