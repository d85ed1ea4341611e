// Synthetic depth images and keypoints lie on the ground-truth body.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/formats/camera_files.h"
#include "core/formats/ntu_skeleton.h"
#include "core/formats/openpose.h"
#include "core/formats/phspd_text.h"
#include "core/formats/png.h"
#include "ingest/inspect/inspect.h"
#include "ingest/synthetic/body_points.h"
#include "ingest/synthetic/rigs.h"
#include "ingest/synthetic/sensors.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

TEST_F(Layouts, TheBodyOccludesItsFarSide) {
  StudioOptions options = Perfect(StudioLayout::kNtu);
  options.subjects = 1;
  options.actions = {"phone_call"};
  Write(options);
  const auto share = [&](const std::string& name) {
    const std::string text = Bytes("nturgb+d_skeletons/" + name + ".skeleton");
    const auto skeleton = ParseNtuSkeleton(text, name);
    double inferred = 0.0, joints = 0.0;
    for (const auto& bodies : skeleton->frames) {
      for (const NtuJoint& joint : bodies.at(0).joints) inferred += joint.tracking == 1 ? 1.0 : 0.0, joints += 1.0;
    }
    return inferred / joints;
  };
  EXPECT_GT(share("S001C003P001R001A028"), share("S001C002P001R001A028") + 0.05);
}

TEST_F(Layouts, AFalseTrackIsAnIntermittentSecondBody) {
  StudioOptions options = Perfect(StudioLayout::kNtu);
  options.subjects = 1;
  options.actions = {"clap"};
  options.false_track_share = 1.0;
  Write(options);
  const std::string text = Bytes("nturgb+d_skeletons/S001C001P001R001A010.skeleton");
  const auto skeleton = ParseNtuSkeleton(text, "S001C001P001R001A010.skeleton");
  ASSERT_TRUE(skeleton);
  const auto with_false_track = std::count_if(skeleton->frames.begin(), skeleton->frames.end(),
                                              [](const auto& bodies) { return bodies.size() == 2; });
  EXPECT_GT(with_false_track, 0);
}

TEST_F(Layouts, MaskedDepthLiesOnTheBodyOfTheSkeleton) {
  StudioOptions options = Perfect(StudioLayout::kNtu);
  options.subjects = 1;
  options.actions = {"salute"};
  options.depth = DepthSensorOptions{true, false, 0, 0.001, 0, 0, 0, 0, 40};
  Write(options);
  const std::string name = "S001C001P001R001A038";
  const std::string bytes = Bytes("nturgb+d_depth_masked/" + name + "/MDepth-00000001.png");
  const auto image = DecodeDepthPng(bytes, "MDepth-00000001.png");
  ASSERT_TRUE(image) << image.error().Message();
  EXPECT_EQ(image->width, 512);
  EXPECT_EQ(image->height, 424);
  const std::string text = Bytes("nturgb+d_skeletons/" + name + ".skeleton");
  const auto skeleton = ParseNtuSkeleton(text, name);
  ASSERT_TRUE(skeleton);
  for (const int k : {0, 1, 3, 13, 17}) {
    const NtuJoint& joint = skeleton->frames[0].at(0).joints[static_cast<std::size_t>(k)];
    const auto u = static_cast<std::size_t>(std::lround(joint.depth_u));
    const auto v = static_cast<std::size_t>(std::lround(joint.depth_v));
    const double depth = 0.001 * image->values[v * 512 + u];
    EXPECT_GT(depth, joint.z_m - 0.25) << k;
    EXPECT_LT(depth, joint.z_m + 0.02) << k;
  }
  EXPECT_TRUE(fs::exists(folder / ("nturgb+d_depth_masked/" + name + "/MDepth-00000041.png")));
  EXPECT_FALSE(fs::exists(folder / ("nturgb+d_depth_masked/" + name + "/MDepth-00000002.png")));
}

TEST_F(Layouts, PhspdRoundTripsToTheGroundTruth) {
  StudioOptions options = Perfect(StudioLayout::kPhspd);
  options.subjects = 1;
  options.actions = {"boxing"};
  options.missing_share = 0.1;
  options.depth = DepthSensorOptions{true, false, 0, 0.001, 0, 0, 0, 0, 30};
  Write(options);
  const std::string recording = "subject01_group3_time1";
  const std::string text = Bytes("phspd/pose/" + recording + "/pose.txt");
  const auto pose = ParsePhspdPose(text, "pose.txt");
  ASSERT_TRUE(pose) << pose.error().Message();
  const auto found =
      std::find_if(truth.begin(), truth.end(), [](const auto& clip) { return clip.first.find("phspd/") == 0; });
  ASSERT_NE(found, truth.end());
  const Motion& motion = found->second;
  EXPECT_LT(pose->frame.size(), static_cast<std::size_t>(motion.frame_count())) << "some frames are not annotated";
  for (std::size_t i = 0; i < pose->frame.size(); ++i) {
    for (int j = 0; j < 24; ++j) {
      const double* at = &pose->position_m[(i * 24 + j) * 3];
      const Vector3d canonical(at[0], -at[1], -at[2]);
      ASSERT_LT((canonical - motion.joints.at(pose->frame[i], j)).norm(), 5e-6);
    }
  }
  // Depth that is back-projected with the calibration of the folder lies around the joints.
  for (const char* file : {"CamParams0906.pkl", "CamParams0909.pkl"}) {
    const nlohmann::json inspection = InspectPath(folder / "phspd" / file, std::nullopt);
    EXPECT_EQ(inspection.at("cameras").size(), 7u) << file;
  }
  for (int view = 1; view <= 3; ++view) {
    const Camera camera = PhspdRig(1)[static_cast<std::size_t>(view)];
    const std::string png = Bytes("phspd/depth/view" + std::to_string(view) + "/" + recording + "/depth_0.png");
    const auto image = DecodeDepthPng(png, "depth_0.png");
    ASSERT_TRUE(image);
    DepthImage upright = *image;  // rotated as in the code of the set
    for (int y = 0; y < 424; ++y) {
      std::reverse(upright.values.begin() + 512 * y, upright.values.begin() + 512 * (y + 1));
    }
    const RigidTransform polar_from_camera = PhspdPolarFromWorld() * Inverse(camera.camera_from_world);
    const std::vector<Vector3d> cloud = BackProject(upright, camera, 0.001);
    ASSERT_GT(cloud.size(), 3000u) << view;
    for (const Vector3d& point : cloud) {
      const Vector3d in_polar = polar_from_camera * point;
      double nearest = 1e9;
      for (int j = 0; j < 24; ++j) {
        const Vector3d joint = motion.joints.at(0, j);
        nearest = std::min(nearest, (in_polar - Vector3d(joint.x(), -joint.y(), -joint.z())).norm());
      }
      ASSERT_LT(nearest, 0.3) << view;
    }
  }
}

TEST_F(Layouts, KeypointsOfAllCamerasTriangulateToTheGroundTruth) {
  for (const RigKind kind : {RigKind::kOwn, RigKind::kHuman36m}) {
    fs::remove_all(folder);
    StudioOptions options = Perfect(StudioLayout::kOpenPose);
    options.subjects = 1;
    options.actions = {"boxing_left_right"};
    options.rig.kind = kind;
    Write(options);
    const std::string calibration_text = Bytes("openpose/calib.json");
    const auto calibration = ParseCalibration(calibration_text, "calib.json");
    ASSERT_TRUE(calibration) << calibration.error().Message();
    ASSERT_EQ(calibration->views.size(), 4u);
    const Motion& motion = truth.begin()->second;
    const JointPositions points = PlacesOf(motion, Body25Places());
    int found = 0;
    for (const CalibratedView& view : calibration->views) {
      const Camera camera = CameraOf(view, calibration->reading, calibration->metres_per_unit);
      const std::string text =
          Bytes("openpose/boxing_left_right_p01_r01/" + view.name + "_json/" + view.name + ".0010.json");
      const auto frame = ParseOpenPose(text, view.name);
      ASSERT_TRUE(frame) << frame.error().Message();
      ASSERT_EQ(frame->people.size(), 1u);
      ASSERT_EQ(frame->people[0].pose.size(), 25u);
      for (int k = 0; k < 25; ++k) {
        const DetectedKeypoint& keypoint = frame->people[0].pose[static_cast<std::size_t>(k)];
        if (!keypoint.detected()) continue;
        ++found;
        const auto pixel = camera.ProjectWorld(points.at(10, k));
        ASSERT_TRUE(pixel);
        EXPECT_LT((*pixel - Vector2d(keypoint.u_px, keypoint.v_px)).norm(), 0.01);
      }
    }
    EXPECT_EQ(found, 100);
  }
}

TEST_F(Layouts, RenderedSequencesHaveTheRecordedLayoutAndAreReadInOneRun) {
  StudioOptions options = Perfect(StudioLayout::kDepthSequence);
  options.clips = 1;
  options.actions = {"throw"};
  options.depth.enabled = true;
  options.rig.kind = RigKind::kRing;
  options.rig.cameras = 1;
  options.rig.width = 128;
  options.rig.height_px = 106;
  options.rig.focal_px = 91;
  Write(options);
  const auto both = Ingested("rendered_seq", "rendered_seq");
  ASSERT_EQ(both.size(), 2u);
  for (const auto& [id, clip] : both) EXPECT_EQ(truth.count(id), 1u) << id;
  const auto one = Ingested("rendered_seq", "rendered_seq/p02");
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one.begin()->first.substr(0, 25), "rendered_seq/p02/seq_p02#");
  EXPECT_EQ(one.begin()->second.evidence.depth_views[0].files[0], "depth/cam01_0000.png");
}

TEST_F(Layouts, SequenceDepthLiesOnTheGroundTruthBody) {
  StudioOptions options = Perfect(StudioLayout::kDepthSequence);
  options.subjects = 1;
  options.clips = 1;
  options.actions = {"throw"};
  options.depth = DepthSensorOptions{true, false, 0, 0.001, 0, 0, 0, 0, 1};
  Write(options);
  const auto clips = Ingested("rendered_seq", "rendered_seq");
  ASSERT_EQ(clips.size(), 1u);
  const Clip& clip = clips.begin()->second;
  ASSERT_EQ(truth.count(clip.id()), 1u) << clip.id();
  const Motion& motion = truth.at(clip.id());
  ASSERT_EQ(clip.evidence.depth_views.size(), 3u);
  EXPECT_THAT(clip.segments, ::testing::SizeIs(3)) << "idle, throw, idle";
  const auto actors = ActorsOf(options, 1, nullptr);
  ASSERT_TRUE(actors);
  const BodyView body(actors->front());
  const int frame = motion.frame_count() / 2;
  const std::vector<PosedCapsule> body_shape = body.Capsules(motion, frame);
  for (const DepthView& view : clip.evidence.depth_views) {
    const std::string name = "rendered_seq/" + view.files[static_cast<std::size_t>(frame)].string();
    const auto image = DecodeDepthPng(Bytes(name), name);
    ASSERT_TRUE(image) << image.error().Message();
    const std::vector<Vector3d> cloud = BackProject(*image, view.camera, view.metres_per_unit);
    ASSERT_GT(cloud.size(), 3000u);
    const RigidTransform world_from_camera = Inverse(view.camera.camera_from_world);
    for (const Vector3d& point : cloud) {
      double nearest = 1e9;
      for (const PosedCapsule& capsule : body_shape) {
        nearest = std::min(
            nearest, std::abs(SignedDistance(capsule.begin, capsule.end, capsule.radius, world_from_camera * point)));
      }
      ASSERT_LT(nearest, 0.0015) << view.camera.name;
    }
  }
}

TEST_F(Layouts, AClockOffsetShiftsTheObservations) {
  StudioOptions options = Perfect(StudioLayout::kOpenPose);
  options.subjects = 1;
  options.actions = {"walk"};
  options.rig.cameras = 2;
  options.rig.clock_offset_s = 0.3;
  Write(options);
  const Motion& motion = truth.begin()->second;
  const std::vector<Camera> rig = RingRig(options.rig, SensorKind::kColour);
  const RigFaults faults = FaultsOf(options.rig, rig, options.seed);
  EXPECT_EQ(faults.clock_s[0], 0.0);
  ASSERT_GT(std::abs(faults.clock_s[1]), 0.0);
  const JointPositions points = PlacesOf(motion, Body25Places());
  const std::string text = Bytes("openpose/walk_p01_r01/cam02_json/cam02.0030.json");
  const auto frame = ParseOpenPose(text, "cam02.0030.json");
  ASSERT_TRUE(frame);
  const DetectedKeypoint& hip = frame->people[0].pose[8];
  ASSERT_TRUE(hip.detected());
  double best = 1e9;
  int at = 0;
  for (int f = 0; f < points.frames; ++f) {
    const double off = (*rig[1].ProjectWorld(points.at(f, 8)) - Vector2d(hip.u_px, hip.v_px)).norm();
    if (off < best) best = off, at = f;
  }
  EXPECT_NEAR(at, 30 + 30.0 * faults.clock_s[1], 1.0);
}

}  // namespace
}  // namespace mocurate
