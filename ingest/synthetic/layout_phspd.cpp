#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "core/base/text.h"
#include "core/formats/humanact12_pickle.h"
#include "core/formats/npy.h"
#include "core/formats/phspd_text.h"
#include "ingest/synthetic/humanact12_set.h"
#include "ingest/synthetic/layout.h"
#include "ingest/synthetic/rigs.h"
#include "ingest/synthetic/sensors.h"

namespace mocurate {
namespace {

constexpr std::int64_t kPhspdRateHz = 15;
constexpr double kGapFrames = 4.0;  // mean length of a run without annotation

/// The motion of a recording, in the studio's world, at 15 Hz.
Motion PerformRecording(const PlannedRecording& recording, const std::vector<Actor>& actors) {
  const Actor& actor = actors[static_cast<std::size_t>(recording.subject - 1)];
  return PerformScript(recording.script, actor.subject, actor.skeleton, FrameRate{kPhspdRateHz, 1});
}

/// Frames of a recording that PHSPD annotated: all but some runs of frames. Sorted.
std::vector<int> AnnotatedFrames(const StudioOptions& options, const PlannedRecording& recording) {
  const std::string name = PhspdRecording{recording.subject, recording.group, recording.time}.Name();
  Random random(static_cast<std::uint64_t>(options.seed), "studio.annotated", name);
  const double leaves = 1.0 / kGapFrames;
  const double enters = leaves * options.missing_share / (1.0 - options.missing_share);
  std::vector<int> frames;
  bool is_missing = false;
  for (int f = 0; f < recording.script.frames; ++f) {
    if (!is_missing) frames.push_back(f);
    is_missing = is_missing ? random.Uniform() >= leaves : random.Uniform() < enters;
  }
  return frames;
}

std::string HumanAct12Name(const PlannedRecording& recording, const CutClip& cut) {
  return "P" + ZeroPadded(recording.subject, 2) + "G" + ZeroPadded(recording.group, 2) + "R" +
         ZeroPadded(recording.time, 2) + "F" + ZeroPadded(cut.first, 4) + "T" + ZeroPadded(cut.last, 4) + "A" +
         cut.variant->code;
}

HumanAct12Clip HumanAct12ClipOf(const Motion& motion, const CutClip& cut) {
  HumanAct12Clip clip;
  clip.frames = static_cast<std::size_t>(motion.frame_count());
  clip.joints = motion.joints.xyz;
  clip.label = std::stoi(std::string(cut.variant->code).substr(0, 2)) - 1;
  for (int f = 0; f < motion.frame_count(); ++f) {
    const std::vector<double> pose = RotationVectors(motion, f);
    clip.poses.insert(clip.poses.end(), pose.begin(), pose.end());
  }
  return clip;
}

/// HumanAct12's clips of a recording as .npy below `folder_name`, and their truth; appends name and content.
Status WriteHumanAct12Clips(const StudioOptions& options, const PlannedRecording& recording, const Motion& motion,
                            const std::string& folder_name, StudioFolder& folder,
                            std::vector<std::pair<std::string, HumanAct12Clip>>& published) {
  const Camera colour = PhspdRig(recording.subject)[5];
  const std::vector<int> annotated = AnnotatedFrames(options, recording);
  const std::string person = "P" + ZeroPadded(recording.subject, 2);
  for (const CutClip& cut : recording.clips) {
    std::vector<int> frames;
    for (const int f : annotated) {
      if (f >= cut.first && f <= cut.last) frames.push_back(f);
    }
    if (frames.empty()) continue;
    const std::string name = HumanAct12Name(recording, cut);
    const Motion seen = SelectFrames(motion, frames, colour.camera_from_world);
    HumanAct12Clip clip = HumanAct12ClipOf(seen, cut);
    const std::string npy = WriteNpy({{clip.frames, kPhspdJoints, 3}, "<f8", clip.joints, {}});
    if (Status written = folder.Write(folder_name + "/" + name + ".npy", npy); !written) return written;
    folder.AddTruth(person, "humanact12/" + person + "/" + name, SelectFrames(seen, HalfRotationAboutX()));
    published.emplace_back(name, std::move(clip));
  }
  return {};
}

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
  const std::vector<float> room =
      options.depth.room ? RoomDepth(camera, PixelRays(camera), kWall) : std::vector<float>();
  const std::string below = "phspd/depth/view" + camera.name.substr(1) + "/" + recording + "/depth_";
  return WriteDepthImages(
      options, actor, motion, camera, recording + "/" + camera.name, room, true,
      [&](int f) { return below + std::to_string(f) + ".png"; }, folder);
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
  const std::string person = "subject" + ZeroPadded(planned.subject, 2);
  folder.AddTruth(person, "phspd/" + person + "/" + recording, SelectFrames(seen, HalfRotationAboutX()));
  std::vector<std::pair<std::string, HumanAct12Clip>> published;
  return WriteHumanAct12Clips(options, planned, motion, "phspd/HumanAct12", folder, published);
}

}  // namespace

Status WriteHumanAct12Layout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const std::vector<PlannedRecording> recordings = PlanHumanAct12(options);
  std::vector<std::vector<std::pair<std::string, HumanAct12Clip>>> published(recordings.size());
  Status done = folder.ForEach(recordings.size(), [&](std::size_t i) {
    const Motion motion = PerformRecording(recordings[i], actors);
    return WriteHumanAct12Clips(options, recordings[i], motion, "HumanAct12", folder, published[i]);
  });
  if (!done) return done;
  std::vector<std::pair<std::string, HumanAct12Clip>> all;
  for (auto& part : published) std::move(part.begin(), part.end(), std::back_inserter(all));
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<HumanAct12Clip> clips;
  for (auto& [name, clip] : all) clips.push_back(std::move(clip));
  const Expected<std::string> pickle = EncodeHumanAct12Pickle(clips, "humanact12poses.pkl");
  if (!pickle) return Forward(pickle);
  return folder.Write("humanact12poses.pkl", *pickle);
}

Status WritePhspdLayout(const StudioOptions& options, const std::vector<Actor>& actors, StudioFolder& folder) {
  const std::vector<PlannedRecording> recordings = PlanHumanAct12(options);
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
