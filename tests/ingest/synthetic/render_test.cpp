// Rendered depth of bodies, and the simulated depth sensor.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/body/skinned_body.h"
#include "core/formats/png.h"
#include "core/store/body_file.h"
#include "ingest/synthetic/rigs.h"
#include "ingest/synthetic/script.h"
#include "ingest/synthetic/sensors.h"
#include "ingest/synthetic/tracker.h"
#include "tests/ingest/sources.h"

namespace mocurate {
namespace {

Vector3d VectorOf(const nlohmann::json& json) {
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

/// An independent rendering of the skinned body with pose and cameras: see the README of the recorded data.
TEST(Rendering, MatchesAnIndependentRendererOfTheSkinnedBody) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const std::filesystem::path folder = std::filesystem::path(TestData()) / "clouds/rendered_body";
  const auto body = ReadBodyTemplate(std::filesystem::path(TestData()) / "body_cc0/body_cc0.h5");
  ASSERT_TRUE(body) << body.error().Message();
  const nlohmann::json rendering = nlohmann::json::parse(*ReadFile(folder / "male_wave.json"));
  std::vector<Quaterniond> rotations;
  for (const nlohmann::json& vector : rendering.at("rotvec24")) rotations.push_back(ExpQuaternion(VectorOf(vector)));
  const RestBody posed =
      Posed(*body, body->variants.at("male"), rotations, VectorOf(rendering.at("translation_added")));
  for (const auto& [name, view] : rendering.at("views").items()) {
    const auto image = DecodeDepthPng(*ReadFile(folder / ("male_wave_" + name + ".png")), name);
    ASSERT_TRUE(image);
    Camera camera;
    camera.width = image->width;
    camera.height = image->height;
    const std::vector<double> lens = view.at("fx_fy_cx_cy");
    camera.fx = lens.at(0), camera.fy = lens.at(1), camera.cx = lens.at(2), camera.cy = lens.at(3);
    Matrix3d rotation;
    for (int r = 0; r < 3; ++r) rotation.row(r) = VectorOf(view.at("R_p_to_d")[r]);
    camera.camera_from_world = {Quaterniond(rotation).normalized(), VectorOf(view.at("t_m"))};
    const std::vector<float> depth = RenderMesh(posed.vertices, body->faces, camera, PixelRays(camera));
    int both = 0, differing = 0, off = 0;
    for (std::size_t i = 0; i < depth.size(); ++i) {
      const double theirs = 0.001 * image->values[i];
      if ((theirs > 0.0) != (depth[i] > 0.0F)) ++differing;
      if (theirs == 0.0 || depth[i] == 0.0F) continue;
      ++both;
      if (std::abs(theirs - depth[i]) > 0.0025) ++off;
    }
    EXPECT_GT(both, 4000) << name;
    EXPECT_LT(differing, both / 50) << name << ": pixels differ only along the outline";
    EXPECT_LT(off, both / 100) << name << ": errors of millimetres, except along the outline of a limb";
  }
}

struct Person {
  Actor actor;
  Motion motion;
};

Person Standing(const BodyTemplate* body = nullptr) {
  StudioOptions options;
  const auto actors = ActorsOf(options, 2, body);
  EXPECT_TRUE(actors) << actors.error().Message();
  Script script;
  script.frames = 2;
  Person person{actors->front(), {}};
  person.motion = PerformScript(script, person.actor.subject, person.actor.skeleton, FrameRate{30, 1});
  return person;
}

TEST(Rendering, MatchesSkinAndCapsulesWithinCentimetres) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const auto body = ReadBodyTemplate(std::filesystem::path(TestData()) / "body_cc0/body_cc0.h5");
  ASSERT_TRUE(body);
  const Person skinned = Standing(&*body);
  Person capsules = skinned;
  capsules.actor.body = nullptr;
  const Camera camera = PhspdRig(1)[2];
  const auto rays = PixelRays(camera);
  const auto skin = BodyView(skinned.actor).Depth(skinned.motion, 0, camera, rays);
  const auto body_shape = BodyView(capsules.actor).Depth(capsules.motion, 0, camera, rays);
  double sum = 0.0;
  int both = 0, either = 0;
  for (std::size_t i = 0; i < skin.size(); ++i) {
    if (skin[i] > 0.0F || body_shape[i] > 0.0F) ++either;
    if (skin[i] == 0.0F || body_shape[i] == 0.0F) continue;
    ++both;
    sum += std::abs(static_cast<double>(skin[i]) - body_shape[i]);
  }
  EXPECT_GT(both, either * 3 / 4);
  EXPECT_LT(sum / both, 0.04);
}

TEST(DepthSensor, NoiseGrowsWithTheSquareOfTheDistance) {
  RigOptions ring;
  ring.cameras = 1;
  ring.width = 160;
  ring.height_px = 120;
  ring.focal_px = 150.0;
  const Camera camera = RingRig(ring, SensorKind::kDepth)[0];
  const auto rays = PixelRays(camera);
  DepthSensorOptions options;
  options.noise = 0.004;
  options.flying_share = options.hole_share = options.grazing = 0.0;
  const auto depth_sigma = [&](float distance) {
    const std::vector<float> wall(rays.size(), distance);
    const DepthImage image = SimulateDepth(wall, {}, camera, rays, options, 1, "wall");
    double squares = 0.0;
    for (const std::uint16_t value : image.values) squares += std::pow(0.001 * value - distance, 2.0);
    return std::sqrt(squares / static_cast<double>(image.values.size()));
  };
  EXPECT_NEAR(depth_sigma(1.0F), 0.004, 0.0003);
  EXPECT_NEAR(depth_sigma(3.0F), 0.036, 0.002);
}

TEST(DepthSensor, StepsGrowWithTheDistanceOnRequest) {
  RigOptions ring;
  ring.cameras = 1;
  ring.width = 100;
  ring.height_px = 20;
  const Camera camera = RingRig(ring, SensorKind::kDepth)[0];
  const auto rays = PixelRays(camera);
  DepthSensorOptions options;
  options.noise = options.flying_share = options.hole_share = options.grazing = 0.0;
  options.quantisation = 0.003;
  options.quantisation_growth = 2.0;
  std::vector<float> ramp;
  for (std::size_t i = 0; i < rays.size(); ++i) ramp.push_back(3.0F + 0.0001F * static_cast<float>(i % 100));
  const DepthImage image = SimulateDepth(ramp, {}, camera, rays, options, 1, "ramp");
  std::set<std::uint16_t> values(image.values.begin(), image.values.end());
  EXPECT_LE(values.size(), 2u) << "10 mm of depth at 3 m fall into steps of 27 mm";
}

TEST(DepthSensor, FlyingPixelsOccurOnlyAtTheSilhouette) {
  const Person person = Standing();
  const Camera camera = PhspdRig(1)[2];
  const auto rays = PixelRays(camera);
  const auto body = BodyView(person.actor).Depth(person.motion, 0, camera, rays);
  const std::vector<float> wall(rays.size(), 6.0F);
  DepthSensorOptions options;
  options.noise = options.hole_share = options.grazing = 0.0;
  options.flying_share = 1.0;
  const DepthImage image = SimulateDepth(body, wall, camera, rays, options, 1, "edge");
  int flying = 0, inside = 0, stray = 0;
  for (int y = 1; y + 1 < camera.height; ++y) {
    for (int x = 1; x + 1 < camera.width; ++x) {
      const auto at = [&](int px, int py) { return body[static_cast<std::size_t>(py) * camera.width + px]; };
      const double depth_m = 0.001 * image.values[static_cast<std::size_t>(y) * camera.width + x];
      bool at_edge = false;
      for (const auto& [dx, dy] : {std::pair(-1, 0), std::pair(1, 0), std::pair(0, -1), std::pair(0, 1)}) {
        const double here = at(x, y) > 0.0F ? at(x, y) : 6.0,
                     there = at(x + dx, y + dy) > 0.0F ? at(x + dx, y + dy) : 6.0;
        at_edge = at_edge || std::abs(here - there) > 0.06;
      }
      const double truth = at(x, y) > 0.0F ? at(x, y) : 6.0;
      if (at_edge && std::abs(depth_m - truth) > 0.05) ++flying;
      if (at(x, y) > 0.0F) ++inside;
      if (!at_edge && std::abs(depth_m - truth) > 0.002) ++stray;
    }
  }
  EXPECT_GT(flying, 300);
  EXPECT_LT(flying, inside / 4);
  EXPECT_EQ(stray, 0);
}

TEST(DepthSensor, HolesHaveTheRequestedShare) {
  const Camera camera = PhspdRig(1)[2];
  const auto rays = PixelRays(camera);
  DepthSensorOptions options;
  options.hole_share = 0.05;
  options.grazing = options.flying_share = 0.0;
  const DepthImage image = SimulateDepth(std::vector<float>(rays.size(), 2.0F), {}, camera, rays, options, 1, "holes");
  const auto holes = std::count(image.values.begin(), image.values.end(), 0);
  EXPECT_NEAR(static_cast<double>(holes) / static_cast<double>(image.values.size()), 0.05, 0.003);
}

TEST(Rigs, PointThePhspdCamerasAtTheSubject) {
  for (const int subject : {1, 4}) {
    for (const Camera& camera : PhspdRig(subject)) {
      const auto pixel = camera.ProjectWorld(Vector3d(0.0, 1.0, 0.0));
      ASSERT_TRUE(pixel) << camera.name;
      EXPECT_NEAR(pixel->x() / camera.width, 0.5, 0.22) << camera.name;
      EXPECT_NEAR(pixel->y() / camera.height, 0.5, 0.30) << camera.name;
      const double away = camera.Centre().norm();
      EXPECT_GT(away, 2.0);
      EXPECT_LT(away, 5.0);
    }
  }
  for (const Camera& camera : Human36mRig()) {
    EXPECT_TRUE(camera.ProjectWorld(Vector3d(0.0, 1.0, 0.0))) << camera.name;
    EXPECT_NEAR(camera.Centre().y(), 1.55, 0.15) << camera.name << ": 1465 to 1633 mm above the floor";
  }
}

TEST(Rigs, PlaceAMovedCameraOffItsCalibration) {
  RigOptions options;
  options.moved = 0.2;
  const std::vector<Camera> rig = RingRig(options, SensorKind::kDepth);
  const RigFaults faults = FaultsOf(options, rig, 5);
  for (std::size_t k = 0; k + 1 < rig.size(); ++k) EXPECT_LT((faults.real[k].Centre() - rig[k].Centre()).norm(), 1e-12);
  EXPECT_GT((faults.real.back().Centre() - rig.back().Centre()).norm(), 0.1);
}

std::vector<ImagePoint> ManyPoints(bool hidden) {
  std::vector<ImagePoint> points;
  for (int i = 0; i < 20000; ++i) points.push_back({Vector2d(500.0, 400.0), hidden});
  return points;
}

TEST(Keypoints, HaveTheErrorsOfTheDetectorOptions) {
  KeypointOptions options;
  options.noise = 0.0;
  options.miss_share = 0.1;
  options.wrong_share = 0.05;
  const OpenPosePerson person = Detected(ManyPoints(false), options, 1, "x");
  int missed = 0, wrong = 0;
  for (const DetectedKeypoint& keypoint : person.pose) {
    if (!keypoint.detected()) ++missed;
    if (keypoint.detected() && std::hypot(keypoint.u_px - 500.0, keypoint.v_px - 400.0) > 10.0) ++wrong;
  }
  EXPECT_NEAR(missed / 20000.0, 0.1, 0.01);
  EXPECT_NEAR(wrong / 20000.0, 0.05 * 0.9, 0.01);
}

TEST(Keypoints, AreDetectedLessOftenAndLessConfidentlyWhenOccluded) {
  KeypointOptions options;
  options.hidden_share = 0.4;
  const auto measure = [&](bool hidden) {
    const OpenPosePerson person = Detected(ManyPoints(hidden), options, 1, "x");
    double found = 0.0, confidence = 0.0;
    for (const DetectedKeypoint& keypoint : person.pose) {
      if (keypoint.detected()) found += 1.0, confidence += keypoint.confidence;
    }
    return std::pair(found / 20000.0, confidence / found);
  };
  const auto [visible, visible_confidence] = measure(false);
  const auto [hidden, hidden_confidence] = measure(true);
  EXPECT_NEAR(visible, 0.97, 0.01);
  EXPECT_NEAR(hidden, 0.4, 0.02);
  EXPECT_LT(hidden_confidence, 0.7 * visible_confidence);
}

JointPositions Still(int frames) {
  JointPositions positions(frames, 2);
  for (int f = 0; f < frames; ++f)
    positions.at(f, 0) = Vector3d(0.3, 1.0, 0.0), positions.at(f, 1) = Vector3d(-0.3, 1.0, 0.0);
  return positions;
}

TEST(Tracker, ProducesEachRequestedErrorSeparately) {
  const std::vector<std::string> names = {"left_wrist", "right_wrist"};
  const TrackerOptions none{0, 0, 0, 4, 0, 0.15, 0.5, 0, 2, 0, 0, 8};
  const int frames = 4000;
  const JointPositions truth = Still(frames);

  TrackerOptions frozen = none;
  frozen.noise = 0.01;
  frozen.frozen_share = 0.2;
  const TrackedTake stuck = Track(truth, names, frozen, 1, "a");
  int repeats = 0;
  for (int f = 1; f < frames; ++f) repeats += stuck.positions.at(f, 0) == stuck.positions.at(f - 1, 0) ? 1 : 0;
  EXPECT_NEAR(repeats / static_cast<double>(frames), 0.2, 0.05);

  TrackerOptions bias = none;
  bias.bias = 0.03;
  const TrackedTake moved = Track(truth, names, bias, 1, "a"), elsewhere = Track(truth, names, bias, 1, "b");
  const Vector3d offset = moved.positions.at(0, 0) - truth.at(0, 0);
  EXPECT_GT(offset.norm(), 0.003);
  EXPECT_LT((moved.positions.at(100, 0) - truth.at(100, 0) - offset).norm(), 1e-12);
  EXPECT_EQ(moved.positions.xyz, elsewhere.positions.xyz);

  TrackerOptions slow = none;
  slow.wander = 0.03;
  slow.wander_frames = 10.0;
  const TrackedTake drifting = Track(truth, names, slow, 1, "a");
  double squares = 0.0, steps = 0.0;
  for (int f = 1; f < frames; ++f) {
    squares += (drifting.positions.at(f, 0) - truth.at(f, 0)).squaredNorm();
    steps += (drifting.positions.at(f, 0) - drifting.positions.at(f - 1, 0)).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(squares / frames), 0.03, 0.004);
  EXPECT_LT(std::sqrt(steps / frames), 0.006) << "the change between frames is small";

  TrackerOptions swap = none;
  swap.swap_share = 1.0;
  swap.swap_frames = 5;
  int swapped = 0, takes = 0;
  for (int take = 0; take < 40; ++take) {
    const TrackedTake tracked = Track(truth, names, swap, 1, std::to_string(take));
    int frames_swapped = 0;
    for (int f = 0; f < frames; ++f) frames_swapped += tracked.positions.at(f, 0).x() < 0.0 ? 1 : 0;
    EXPECT_TRUE(frames_swapped == 0 || frames_swapped == 5) << frames_swapped;
    swapped += frames_swapped > 0 ? 1 : 0;
    ++takes;
  }
  EXPECT_NEAR(swapped, takes / 2, 12) << "half of the takes swap arms, the other half legs";

  TrackerOptions often = none;
  often.swapped_share = 0.15;
  often.swap_frames = 3;
  const TrackedTake again = Track(truth, names, often, 1, "a");
  int exchanged = 0, times = 0;
  for (int f = 1; f < frames; ++f) {
    const bool now = again.positions.at(f, 0).x() < 0.0;
    exchanged += now ? 1 : 0;
    times += now && again.positions.at(f - 1, 0).x() > 0.0 ? 1 : 0;
  }
  EXPECT_NEAR(exchanged / static_cast<double>(frames), 0.10, 0.03) << "a third of the swaps affect only the legs";
  EXPECT_NEAR(exchanged / static_cast<double>(times), 3.0, 0.7);
}

}  // namespace
}  // namespace mocurate
