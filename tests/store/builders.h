#pragma once

#include <hdf5.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/base/file.h"
#include "core/base/random.h"
#include "core/motion/kinematics.h"
#include "core/store/store.h"
#include "tests/support/scratch_folder.h"

/// Small data in which every field of the store is used.
namespace mocurate::test {

/// Without the care (and the time) of WriteFile.
inline void PutBytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// Pelvis, two hips with knees, head; with limits, synonyms, a landmark, a reflection and Lie chains.
inline SkeletonPtr Walker() {
  Skeleton s;
  s.name = "walker";
  const auto add = [&s](const char* name, int parent, Vector3d offset, int mirror) {
    Joint joint;
    joint.name = name;
    joint.parent = parent;
    joint.rest_offset = offset;
    joint.mirror = mirror;
    s.joints.push_back(joint);
  };
  add("pelvis", -1, Vector3d::Zero(), 0);
  add("left_hip", 0, {0.1, -0.05, 0}, 2);
  add("right_hip", 0, {-0.1, -0.05, 0}, 1);
  add("left_knee", 1, {0, -0.4, 0}, 4);
  add("right_knee", 2, {0, -0.4, 0}, 3);
  add("head", 0, {0, 0.6, 0}, 5);
  s.joints[0].synonyms = {"hips", "root joint"};
  s.joints[3].limits = JointLimits{{0, -0.2, -0.1}, {2.5, 0.2, 0.1}};
  s.joints[3].radius = 0.08;
  s.joints[5].landmark = true;
  s.joints[5].reflection = Vector3d(-1, 1, 1).asDiagonal();
  s.landmarks = {{"nose", 5, {0, 0.05, 0.1}}};
  LieChains lie;
  lie.chains = {{0, 1, 3}, {0, 2, 4}, {0, 5}};
  lie.raw_offsets = {Vector3d::Zero(),   Vector3d::UnitX(),  -Vector3d::UnitX(),
                     -Vector3d::UnitY(), -Vector3d::UnitY(), Vector3d::UnitY()};
  s.lie = lie;
  return std::make_shared<Skeleton>(s);
}

inline Motion Wander(const SkeletonPtr& skeleton, FrameRate rate, int frames, const std::string& item) {
  Random random(7, "store test", item);
  std::vector<Vector3d> root;
  std::vector<Quaterniond> rotation;
  for (int f = 0; f < frames; ++f) {
    root.emplace_back(random.Uniform(-2, 2), random.Uniform(0.8, 1.1), random.Uniform(-2, 2));
    for (int j = 0; j < skeleton->joint_count(); ++j) {
      rotation.push_back(Quaterniond(random.Normal(), random.Normal(), random.Normal(), random.Normal()).normalized());
    }
  }
  std::vector<double> bones = skeleton->RestBoneLengths();
  for (double& bone : bones) bone *= random.Uniform(0.9, 1.1);
  return MakeMotion(skeleton, rate, root, rotation, bones);
}

/// The walker with other hips.
inline SkeletonPtr OtherWalker() {
  auto own = std::make_shared<Skeleton>(*Walker());
  own->joints[1].rest_offset = {0.06, -0.08, -0.02};
  own->joints[2].rest_offset = {-0.06, -0.08, -0.02};
  return own;
}

inline void AddOptionalFields(Motion& motion) {
  const std::size_t cells = motion.rotation.size();
  Random random(7, "optional", "");
  for (std::size_t i = 0; i < cells; ++i) {
    motion.state.push_back(static_cast<JointState>(i % 4));
    for (int k = 0; k < 6; ++k) motion.position_cov.push_back(static_cast<float>(random.Uniform(0, 1e-3)));
    for (int k = 0; k < 3; ++k) motion.rotation_sigma.push_back(static_cast<float>(random.Uniform(0, 0.1)));
    for (int k = 0; k < 3; ++k) motion.rotation_observed.push_back(static_cast<float>(random.Uniform()));
  }
  for (int i = 0; i < 2 * motion.frame_count(); ++i) motion.contact.push_back(static_cast<std::uint8_t>(i % 2));
}

inline Clip MakeClip(const std::string& person, const std::string& recording, int frames) {
  Clip clip;
  clip.identity = {"KARD", person, recording, "morning", "front", "CC-BY-4.0", 5, 5 + frames};
  clip.label = "walk";
  clip.rate = {120000, 1001};
  clip.segments = {{0.0, 0.04, "step", "locomotion", "annotated"}, {0.02, 0.06, "transition", "", "measured"}};
  clip.canonical_from_source = {Quaterniond(Eigen::AngleAxisd(0.3, Vector3d::UnitY())), {1, 2, 3}};
  clip.fit_rms = 0.0123;
  clip.role = "train";
  clip.evidence_sha256 = std::string(64, 'a');
  clip.provenance = {{"file", "Grüße \"1\".txt"}, {"program", "mocurate 0.1"}};
  return clip;
}

/// Three clips of two persons, every field used, one clip without the optional fields.
inline Dataset MakeDataset() {
  Dataset dataset;
  dataset.skeleton = Walker();
  dataset.clips = {MakeClip("p1", "a", 7), MakeClip("p1", "b", 9), MakeClip("p2", "a", 5)};
  for (Clip& clip : dataset.clips) {
    const SkeletonPtr body = clip.identity.person == "p2" ? OtherWalker() : dataset.skeleton;
    clip.motion = Wander(body, clip.rate, clip.identity.end_frame - clip.identity.begin_frame, clip.id());
  }
  for (Clip& clip : dataset.clips) clip.provenance[kHeightOrigin] = kOriginFloor;  // in /about
  AddOptionalFields(*dataset.clips[0].motion);
  AddOptionalFields(*dataset.clips[2].motion);
  dataset.clips[1].label = "run";
  dataset.clips[1].fine_label = "jog";
  dataset.labels = {"locomotion", "run", "walk"};
  dataset.fine_labels = {{"jog", 1}, {"stroll", 2}};
  dataset.splits = {{"by_person", {0, 1}, {}, {2}, "persons p1 | p2", "ok: no person in two parts"},
                    {"fold 2", {2}, {1}, {0}, "drawn", "p1 in two parts"}};
  dataset.findings = {
      {"KARD/p1/a#5-12", "skate", Severity::kWarning, 1, 3, "left_knee", 0.25, 0.0, "slides 0.25 m",
       FindingAction::kKept},
      {"KARD/p9/z#0-1", "too_short", Severity::kError, 0, 0, "", 1.0, 0.0, "1 frame", FindingAction::kDropped},
      {"KARD/p2/a#5-10", "rate", Severity::kInfo, 0, 0, "", 120, 0.0, "by file name", FindingAction::kKept}};
  dataset.recipe = "ingest:\n  path: data\n";
  dataset.created_by = "mocurate 0.1.0";
  return dataset;
}

inline Dataset MakeJointsOnlyDataset() {
  Dataset dataset = MakeDataset();
  dataset.joints_only = true;
  for (Clip& clip : dataset.clips) clip.motion = MakeJointsOnly(dataset.skeleton, clip.rate, clip.motion->joints);
  return dataset;
}

inline DepthView MakeView(const std::string& name) {
  DepthView view;
  view.camera.name = name;
  view.camera.width = 640;
  view.camera.height = 480;
  view.camera.fx = 525.5;
  view.camera.fy = 525.25;
  view.camera.cx = 319.5;
  view.camera.cy = 239.5;
  view.camera.distortion = {0.1, -0.2, 0.001, -0.002, 0.03};
  view.camera.camera_from_world = {Quaterniond(Eigen::AngleAxisd(1.2, Vector3d(1, 2, 3).normalized())), {0, -1, 4}};
  view.files = {"depth/000 1.png", "depth/\xff\xfe.png"};
  view.sha256 = {std::string(64, '1'), ""};
  view.time_s = {0.0, 1.0 / 30};
  return view;
}

/// Three images: one person, no person, two people.
inline KeypointView MakeKeypointView(const std::string& name) {
  KeypointView view;
  view.camera = MakeView(name).camera;
  view.time_s = {0.0, 1.0 / 30, 2.0 / 30};
  view.people = 2;
  view.values = {10.5, -3.25, 0.5, 0, 0, 0,   0, 0, 0, 0, 0, 0,  // one person, the second point not detected
                 0,    0,     0,   0, 0, 0,   0, 0, 0, 0, 0, 0,  // no person
                 11.5, 4,     1,   7, 8, 0.1, 1, 2, 1, 3, 4, 0.75};
  return view;
}

inline Clip MakeEvidenceClip(bool with_motion) {
  Clip clip = MakeClip("p1", "a", 3);
  clip.fine_label = "stroll";
  JointTracks tracks;
  tracks.names = {"hip centre", "Knie links"};
  tracks.time_s = {0.0, 0.1, 0.25};
  tracks.positions = JointPositions(3, 2);
  for (std::size_t i = 0; i < tracks.positions.xyz.size(); ++i) tracks.positions.xyz[i] = 0.1 * static_cast<double>(i);
  tracks.confidence = {1, 0.5, 0, 1, 0.25, 1};
  tracks.rotation_confidence = {0, 1, 0.5, 1, 0, 1};
  for (int i = 0; i < 6; ++i) tracks.rotation.push_back(ExpQuaternion(Vector3d(0.1 * i, -0.2, 0.3)));
  for (const std::size_t i : {0, 4}) tracks.rotation[i] = Quaterniond::Identity();  // not recorded
  clip.evidence.tracks = tracks;
  clip.evidence.depth_views = {MakeView("left"), MakeView("right")};
  clip.evidence.depth_views[1].masks = {"masks/0.jpg", "masks/1.jpg"};
  clip.evidence.depth_views[1].mask_sha256 = {std::string(64, '2'), std::string(64, '3')};
  clip.evidence.clouds = CloudFiles{{"clouds/000 1.ply", "", "clouds/\xff\xfe.pcd"},
                                    {std::string(64, '4'), "", ""},
                                    {0.0, 0.1, 0.25},
                                    -0.001,
                                    MakeView("").camera.camera_from_world};
  clip.evidence.keypoint_names = {"nose", "left_knee"};
  clip.evidence.keypoint_views = {MakeKeypointView("cam01"), MakeKeypointView("cam02")};
  clip.evidence.keypoint_views[1].people = 0;
  clip.evidence.keypoint_views[1].values.clear();
  clip.evidence.subject = 1;
  if (with_motion) {
    clip.motion = Wander(OtherWalker(), clip.rate, 3, "evidence");
    clip.motion->rotation_reference = Walker();
    AddOptionalFields(*clip.motion);
  }
  return clip;
}

inline Truth MakeTruth() {
  Truth truth;
  const SkeletonPtr skeleton = Walker();
  truth.motion["s/p/a#0-4"] = Wander(skeleton, {30, 1}, 4, "a");
  truth.motion["s/p/b#0-6"] = Wander(OtherWalker(), {60, 1}, 6, "b");
  AddOptionalFields(truth.motion["s/p/a#0-4"]);
  return truth;
}

}  // namespace mocurate::test
