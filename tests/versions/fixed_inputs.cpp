#include "tests/versions/fixed_inputs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/base/pi.h"
#include "core/base/random.h"
#include "core/base/sha256.h"
#include "core/motion/kinematics.h"
#include "tests/support/depth_files.h"
#include "tests/support/render_depth.h"

namespace mocurate::versions {
namespace {

bool Has(const std::string& name, const char* word) { return name.find(word) != std::string::npos; }

}  // namespace

Motion Exercise(int frames, double vigour, const std::string& name) {
  const SkeletonPtr skeleton = LoadSkeleton(name).value();
  std::vector<Vector3d> root;
  std::vector<Quaterniond> rotation;
  for (int f = 0; f < frames; ++f) {
    const double phase = std::min(1.0, std::max(0.0, (f - 0.25 * frames) / (0.5 * frames)));
    const double swing = vigour * std::sin(kPi * phase) * std::sin(2.0 * kPi * phase);
    root.emplace_back(0.1 * vigour * phase, 0.9 + 0.05 * swing, -2.5);
    for (const Joint& joint : skeleton->joints) {
      Vector3d turn = Vector3d::Zero();
      if (Has(joint.name, "shoulder")) turn = Vector3d(0.2, 0.1, 1.1) * swing;
      if (Has(joint.name, "elbow")) turn = Vector3d(0.1, 0.7, 0.0) * swing;
      if (Has(joint.name, "left_hip")) turn = Vector3d(-0.6, 0.0, 0.05) * swing;
      if (joint.parent < 0) turn = Vector3d(0.02, 0.4 + 0.2 * phase, 0.0);
      rotation.push_back(ExpQuaternion(turn));
    }
  }
  std::vector<double> bones = skeleton->RestBoneLengths();
  for (double& bone : bones) bone *= 1.04;
  return MakeMotion(skeleton, FrameRate{30, 1}, std::move(root), std::move(rotation), bones);
}

Clip TrackedClip(const std::string& person, const std::string& recording, const std::string& label,
                 const Motion& motion) {
  const int frames = motion.frame_count();
  Clip clip;
  clip.identity = {"fixed", person, recording, "", "", "CC0", 0, frames};
  clip.label = label;
  clip.rate = motion.rate;
  JointTracks tracks;
  tracks.positions = JointPositions(frames, motion.joint_count() - 1);
  Random random(11, "fixed input", clip.id());
  for (int f = 0; f < frames; ++f) {
    tracks.time_s.push_back(motion.rate.FrameTime(f));
    for (int j = 1; j < motion.joint_count(); ++j) {
      const Vector3d noise(random.Normal(), random.Normal(), random.Normal());
      tracks.positions.at(f, j - 1) = motion.joints.at(f, j) + 0.01 * noise;
      tracks.confidence.push_back(random.Uniform() < 0.03 ? 0.0 : 1.0);
    }
  }
  for (int j = 1; j < motion.joint_count(); ++j) tracks.names.push_back(motion.skeleton->joints[j].name);
  clip.evidence.tracks = std::move(tracks);
  return clip;
}

Clip RecordedClip(const std::string& person, const std::string& recording, const Motion& motion,
                  const std::filesystem::path& folder) {
  constexpr int kCameras = 3;
  const Vector3d middle = motion.root_translation.front();
  const BoneCapsules body = BoneCapsules::Make(motion.skeleton);
  Clip clip = TrackedClip(person, recording, "wave", motion);
  Random random(12, "fixed views", clip.id());
  for (const Joint& joint : motion.skeleton->joints) clip.evidence.keypoint_names.push_back(joint.name);
  std::filesystem::create_directories(folder);
  for (int v = 0; v < kCameras; ++v) {
    const double angle = 2.0 * kPi * (v + 0.2) / kCameras;
    const Vector3d from(std::sin(angle), 0.0, std::cos(angle));
    Matrix3d camera_from_world;
    camera_from_world << Vector3d::UnitY().cross(from).transpose(), -Vector3d::UnitY().transpose(), -from.transpose();
    Camera camera;
    camera.name = "camera" + std::to_string(v);
    camera.width = 240, camera.height = 260;
    camera.fx = camera.fy = 260.0;
    camera.cx = 119.5, camera.cy = 129.5;
    camera.camera_from_world = {Quaterniond(camera_from_world), -(camera_from_world * (middle + 2.8 * from))};
    DepthView depth;
    KeypointView keypoints;
    depth.camera = keypoints.camera = camera;
    depth.time_s = keypoints.time_s = clip.evidence.tracks->time_s;
    keypoints.people = 1;
    for (int f = 0; f < motion.frame_count(); ++f) {
      std::vector<Vector3d> joints;
      for (int j = 0; j < motion.joint_count(); ++j) {
        joints.emplace_back(motion.joints.at(f, j));
        const Vector3d seen = camera.camera_from_world * joints.back();
        const bool missed = random.Uniform() < 0.05;
        keypoints.values.insert(keypoints.values.end(),
                                {camera.cx + camera.fx * seen.x() / seen.z() + 3.0 * random.Normal(),
                                 camera.cy + camera.fy * seen.y() / seen.z() + 3.0 * random.Normal(),
                                 missed ? 0.0 : random.Uniform(0.5, 1.0)});
      }
      DepthImage image{camera.width, camera.height, {}};
      for (const float metres : RenderDepth(body, joints.data(), camera))
        image.values.push_back(static_cast<std::uint16_t>(std::lround(1000.0 * metres)));
      depth.files.push_back(folder / (camera.name + "_" + std::to_string(f) + ".png"));
      EXPECT_TRUE(WriteDepthImage(image, depth.files.back()));
      depth.sha256.push_back(Sha256OfFile(depth.files.back()).value());
    }
    clip.evidence.depth_views.push_back(std::move(depth));
    clip.evidence.keypoint_views.push_back(std::move(keypoints));
  }
  return clip;
}

Dataset FittedClip(const Clip& tracked, const Motion& motion) {
  Dataset dataset;
  dataset.skeleton = motion.skeleton;
  dataset.created_by = "a test";
  Clip clip = tracked;
  clip.evidence = Evidence();
  clip.motion = motion;
  dataset.clips = {clip};
  return dataset;
}

Dataset SmallDataset() {
  Dataset dataset;
  dataset.joints_only = true;
  dataset.created_by = "a test";
  dataset.labels = {"calm", "lively"};
  Split split;
  split.name = "person";
  split.rule = "by person";
  split.leak_check = "ok";
  for (const char* person : {"p1", "p2", "p3"}) {
    for (const bool lively : {false, true}) {
      for (int k = 0; k < 2; ++k) {
        const Motion motion = Exercise(24 + 2 * k + (lively ? 1 : 0), lively ? 0.9 + 0.1 * k : -0.5 - 0.1 * k);
        dataset.skeleton = motion.skeleton;
        Clip clip;
        clip.identity = {
            "fixed", person, (lively ? "lively" : "calm") + std::to_string(k), "", "", "", 0, motion.frame_count()};
        clip.label = lively ? "lively" : "calm";
        clip.rate = motion.rate;
        clip.motion = MakeJointsOnly(motion.skeleton, motion.rate, motion.joints);
        (person[1] == '3' ? split.test : split.train).push_back(static_cast<int>(dataset.clips.size()));
        dataset.clips.push_back(std::move(clip));
      }
    }
  }
  dataset.splits = {split};
  return dataset;
}

std::string JointTable(const Motion& motion) {
  std::string table;
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 1; j < motion.joint_count(); ++j) {
      const Vector3d mm = 1000.0 * motion.joints.at(f, j);
      char row[128];
      std::snprintf(row, sizeof row, "%.3f %.3f %.3f 1\n", mm.x(), mm.y(), -mm.z());
      table += row;
    }
  }
  return table;
}

std::string BvhText() {
  std::string text =
      "HIERARCHY\nROOT Hips\n{\n OFFSET 0 90 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation "
      "Yrotation\n"
      " JOINT UpperLeg_L\n {\n  OFFSET 10 -5 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n"
      "  JOINT LowerLeg_L\n  {\n   OFFSET 0 -42 0\n   CHANNELS 3 Xrotation Yrotation Zrotation\n"
      "   End Site\n   {\n    OFFSET 0 -40 0\n   }\n  }\n }\n}\nMOTION\nFrames: 12\nFrame Time: 0.0333333\n";
  for (int f = 0; f < 12; ++f) {
    char row[160];
    std::snprintf(row, sizeof row, "%d 90.5 %d 1 2 %d 0 %d 3 %d 0 -1\n", f, -f, 4 * f, 5 * f - 20, 6 * f);
    text += row;
  }
  return text;
}

nlohmann::json RunSummary(const std::string& clip) {
  const nlohmann::json measures = {{"frames", 40},          {"bone_spread_mm", 9.5}, {"jerk", 80.25},
                                   {"missing_share", 0.03}, {"frozen_frames", 0},    {"foot_skate", 0.125}};
  return {
      {"name", "fixed"},
      {"description", "One clip."},
      {"takes", "no time"},
      {"created_by", "a test"},
      {"audit",
       {{"clips", 1},
        {"frames", 40},
        {"seconds", 1.5},
        {"per_label", {{"wave", 1}}},
        {"splits", nlohmann::json::array()}}},
      {"fit_error",
       {{"joint_mm", 8.5},
        {"evidence_mm", 30.25},
        {"rotation_deg", 3.5},
        {"bone_direction_deg", 2.5},
        {"frames", 40},
        {"clips", 1},
        {"sigma",
         {{"large_error_mm", 50},
          {"groups",
           {{"all",
             {{"positions",
               {{"samples", 600},
                {"within_one_sigma", 0.5},
                {"within_two_sigma", 0.75},
                {"ece", 0.125},
                {"spearman", 0.25},
                {"risk_coverage_mm", {1.0, 2.0, 3.0}},
                {"ideal_risk_coverage_mm", {0.5, 1.0, 3.0}},
                {"auc", nullptr}}}}}}}}}}},
      {"stages", {{{"stage", "fitting"}, {"items", 1}, {"done", 1}, {"suspect", 0}, {"refused", 0}, {"crashed", 0}}}},
      {"clips",
       {{{"item", clip},
         {"kept", true},
         {"ingest", {{"person", "p1"}, {"label", "wave"}, {"frames", 40}, {"missing_share", 0.03}}},
         {"fitting",
          {{"method", "joint_tracks"},
           {"residual_rms_mm", 8.5},
           {"residual_p95_mm", 17.5},
           {"iterations", 12},
           {"before", measures},
           {"after", measures}}},
         {"canon", {{"clips", 1}}},
         {"findings", nlohmann::json::array()}}}},
      {"persons",
       {{"p1", {{"person", "p1"}, {"bone_length_m", {{"left_knee", 0.4}}}, {"stature_m", 1.6}, {"clips", 1}}}}}};
}

}  // namespace mocurate::versions
