
#include "core/formats/phspd_text.h"
#include "core/formats/png.h"
#include "ingest/synthetic/body_view.h"
#include "ingest/synthetic/depth_sensor.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/phspd_annotation.h"
#include "ingest/synthetic/rigs.h"

namespace mocurate {
namespace {

constexpr double kWall = 1.6;  // metres behind the subject

/// pose.txt and shape_smpl.txt of the annotated frames, in the axes of the polarisation camera. Without SMPL's own
/// bodies betas are 0, and the translation is the pelvis.
Status WriteAnnotation(const Motion& seen, const std::vector<int>& frames, const std::string& recording,
                       StudioFolder& folder) {
  PhspdPose pose;
  PhspdShape shape;
  for (const int f : frames) {
    pose.frame.push_back(f);
    shape.frame.push_back(f);
    for (int j = 0; j < seen.joint_count(); ++j) {
      const Vector3d at = seen.joints.at(f, j);
      pose.position_m.insert(pose.position_m.end(), at.data(), at.data() + 3);
    }
    const Vector3d root = seen.root_translation[f];
    shape.translation_m.insert(shape.translation_m.end(), root.data(), root.data() + 3);
    const std::vector<double> vectors = RotationVectors(seen, f);
    shape.pose_rad.insert(shape.pose_rad.end(), vectors.begin(), vectors.end());
    shape.betas.insert(shape.betas.end(), kPhspdBetas, 0.0);
  }
  const std::string name = "phspd/pose/" + recording + "/";
  if (Status written = folder.Write(name + "pose.txt", WritePhspdPose(pose)); !written) return written;
  return folder.Write(name + "shape_smpl.txt", WritePhspdShape(shape));
}

/// depth/viewK/RECORDING/depth_F.png of one camera: millimetres, mirrored, as the set's own code reads them.
Status WriteViewDepth(const StudioOptions& options, const Actor& actor, const Motion& motion, const Camera& camera,
                      const std::string& recording, StudioFolder& folder) {
  const std::vector<Vector2d> rays = PixelRays(camera);
  const std::vector<float> room = options.depth.room ? RoomDepth(camera, rays, kWall) : std::vector<float>();
  const BodyView body(actor);
  const std::string view = "view" + camera.name.substr(1);
  for (int f = 0; f < motion.frame_count(); f += static_cast<int>(options.depth.every)) {
    const std::string item = recording + "/" + camera.name + "/" + std::to_string(f);
    const DepthImage image = Mirrored(
        SimulateDepth(body.Depth(motion, f, camera, rays), room, camera, rays, options.depth, options.seed, item));
    const Expected<std::string> png = EncodePng(image);
    if (!png) return Forward(png);
    Status written =
        folder.Write("phspd/depth/" + view + "/" + recording + "/depth_" + std::to_string(f) + ".png", *png);
    if (!written) return written;
  }
  return {};
}

/// Four items write a recording's clips, its annotation and its views, so that several threads share one recording.
Status WriteRecording(const StudioOptions& options, const PlannedRecording& planned, const Actor& actor,
                      const Motion& motion, int part, StudioFolder& folder) {
  const std::string recording = PhspdRecording{planned.subject, planned.group, planned.time}.Name();
  const std::vector<Camera> rig = PhspdRig(planned.subject);
  if (part > 0) {
    const std::vector<Camera> depth = {rig[1], rig[2], rig[3]};
    const RigFaults faults = FaultsOf(options.rig, depth, options.seed);
    const auto k = static_cast<std::size_t>(part - 1);
    return WriteViewDepth(options, actor, DelayBy(motion, faults.clock_s[k]), faults.real[k], recording, folder);
  }
  const Motion seen = SelectFrames(motion, rig[0].camera_from_world);
  Status annotated = WriteAnnotation(seen, AnnotatedFrames(options, planned), recording, folder);
  if (!annotated) return annotated;
  ClipIdentity identity;
  identity.source = "phspd";
  identity.person = "subject" + Digits(planned.subject, 2);
  identity.recording = recording;
  identity.end_frame = motion.frame_count();
  folder.AddTruth(identity.person, identity.id(), SelectFrames(seen, HalfRotationAboutX()));
  std::vector<std::pair<std::string, HumanAct12Clip>> published;
  return WriteHumanAct12Clips(options, planned, motion, "phspd/HumanAct12", folder, published);
}

}  // namespace

Status WritePhspdLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const std::vector<PlannedRecording> recordings =
      PlanHumanAct12({options.seed, options.subjects, options.clips, options.actions});
  for (const int subject : {4, 1}) {
    const PhspdCalibration& rig = PhspdCalibrationOf(subject);
    const Expected<std::string> bytes = EncodePhspdCalibration(rig);
    if (!bytes) return Forward(bytes);
    if (Status written = folder.Write(std::string("phspd/") + rig.name + ".pkl", *bytes); !written) return written;
  }
  const std::size_t parts = options.depth.enabled ? 4 : 1;
  return folder.ForEach(parts * recordings.size(), [&](std::size_t i) {
    const PlannedRecording& planned = recordings[i / parts];
    const Motion motion = PerformRecording(planned, actors);
    const Actor& actor = actors[static_cast<std::size_t>(planned.subject - 1)];
    return WriteRecording(options, planned, actor, motion, static_cast<int>(i % parts), folder);
  });
}

}  // namespace mocurate
