#include "ingest/synthetic/rigs.h"

#include <cmath>
#include <set>

#include "core/base/random.h"
#include "core/base/text.h"
#include "core/formats/pickle_writer.h"
#include "ingest/synthetic/actions.h"

namespace mocurate {
namespace {

constexpr double kPerMillimetre = 0.001;
constexpr std::array<double, 7> kPolar = {1893.5938, 1892.8149, 644.4377, 518.6907, -0.06089, 0.43352, -3.03162};
constexpr std::array<std::array<double, 7>, 3> kDepthLens = {
    {{363.9404, 364.1928, 250.2946, 199.3582, 0.09746, -0.26196, -0.06417},
     {364.5329, 364.5890, 251.8789, 202.0007, 0.16361, -0.96310, 1.96097},
     {365.0148, 364.9564, 256.2733, 209.4123, 0.12850, -0.35554, 0.05730}}};
constexpr std::array<std::array<double, 7>, 3> kColourLens = {
    {{1049.7042, 1051.4089, 947.3391, 561.8266, -0.00057, 0.32390, -0.88799},
     {1059.1841, 1059.4705, 978.1714, 563.2187, 0.02274, 0.13494, -0.90114},
     {1050.3691, 1050.6626, 991.6563, 554.4351, 0.00211, 0.45652, -1.80505}}};

const PhspdCalibration kPhspdRigs[] = {
    {"CamParams0906",
     {{{0.9807007, 0.0172438, 0.1914531, 0.0396488, -1804.564, 313.101, -1696.821},
       {0.9742295, -0.0275881, -0.2188766, -0.0463272, 1653.862, 85.656, -1419.499},
       {0.7977922, 0.0313966, -0.5885993, -0.1270846, 4196.949, -286.601, 1041.334}}},
     {{{1.0000000, 0.0029495, 0.0006283, 0.0021396, -51.743, 0.309, -4.580},
       {0.9999526, -0.0026741, -0.0020339, -0.0004388, -52.101, 0.795, -3.748},
       {1.0000159, 0.0017512, -0.0039950, 0.0057711, -51.740, 0.058, -9.994}}}},
    {"CamParams0909",
     {{{0.9760636, 0.0190675, 0.2127169, 0.0414491, -1873.685, 313.200, -1625.934},
       {0.9743798, -0.0232748, -0.2194043, -0.0422455, 1657.482, 129.120, -1422.319},
       {0.7998474, 0.0307227, -0.5858830, -0.1265875, 4189.088, -284.697, 1026.920}}},
     {{{0.9999744, 0.0026054, 0.0011556, 0.0039170, -51.743, 0.309, -4.580},
       {0.9999816, -0.0021322, -0.0016395, -0.0048775, -52.101, 0.795, -3.748},
       {0.9998336, 0.0017654, -0.0047405, 0.0074644, -51.740, 0.058, -9.994}}}}};

RigidTransform TransformOf(const PhspdCalibration::Pose& pose) {
  return {Quaterniond(pose[0], pose[1], pose[2], pose[3]).normalized(),
          kPerMillimetre * Vector3d(pose[4], pose[5], pose[6])};
}

/// `lens` begins with fx fy cx cy.
template <std::size_t N>
Camera PinholeOf(const std::string& name, const std::array<double, N>& lens, int width, int height,
                 const RigidTransform& camera_from_world) {
  Camera camera;
  camera.name = name;
  camera.width = width;
  camera.height = height;
  camera.fx = lens[0], camera.fy = lens[1], camera.cx = lens[2], camera.cy = lens[3];
  camera.camera_from_world = camera_from_world;
  return camera;
}

/// One of Human3.6M's: lens and S1's pose, world z up in millimetres (karfly/human36m-camera-parameters).
struct Human36mCamera {
  const char* name;
  int height;
  std::array<double, 4> pinhole;  // fx fy cx cy
  LensDistortion lens;            // k1 k2 p1 p2 k3
  double r[9];
  double t[3];
};

const Human36mCamera kHuman36m[] = {
    {"54138969",
     1002,
     {1145.049, 1143.781, 512.542, 515.451},
     {-0.20710, 0.24778, -0.00142, -0.00098, -0.00308},
     {-0.915362, 0.401808, 0.025748, 0.051548, 0.180374, -0.982246, -0.399319, -0.897784, -0.185820},
     {-346.05, 546.98, 5474.48}},
    {"55011271",
     1000,
     {1149.676, 1147.592, 508.849, 508.065},
     {-0.19421, 0.24041, -0.00274, -0.00162, 0.00682},
     {0.928168, 0.372154, 0.002248, 0.081664, -0.197772, -0.976840, -0.363090, 0.906856, -0.213958},
     {251.43, 420.94, 5588.20}},
    {"58860488",
     1000,
     {1149.141, 1148.799, 519.816, 501.403},
     {-0.20834, 0.25549, -0.00076, 0.00148, -0.00246},
     {-0.914155, -0.402778, -0.045723, -0.045623, 0.214308, -0.975700, 0.402789, -0.889855, -0.214287},
     {480.48, 253.83, 5704.21}},
    {"60457274",
     1002,
     {1145.511, 1144.774, 514.968, 501.882},
     {-0.19838, 0.21832, -0.00181, -0.00059, -0.00895},
     {0.914156, -0.400607, 0.061906, -0.056410, -0.276953, -0.959226, 0.401418, 0.873390, -0.275777},
     {51.88, 378.42, 4406.15}}};

void PutArray(PickleWriter& writer, const std::string& key, std::vector<std::size_t> shape,
              std::vector<double> values) {
  writer.Text(key);
  writer.Array({std::move(shape), "<f4", std::move(values), {}});
}

}  // namespace

const PhspdCalibration& PhspdCalibrationOf(int subject) {
  static const std::set<int> first = {4, 5, 6, 9, 11, 12};
  return kPhspdRigs[first.count(subject) != 0 ? 0 : 1];
}

RigidTransform PhspdPolarFromWorld() {
  // x right, y down, z forward; the axes meet at (0.118, -0.193, 4.381). From this height all cameras see the feet.
  return {Quaterniond(0.0, 1.0, 0.0, 0.0), Vector3d(0.118, 0.85, 4.381)};
}

std::vector<Camera> PhspdRig(int subject) {
  const PhspdCalibration& rig = PhspdCalibrationOf(subject);
  const RigidTransform polar = PhspdPolarFromWorld();
  std::vector<Camera> cameras = {PinholeOf("p", kPolar, 1224, 1024, polar)};
  for (int k = 0; k < 3; ++k) {
    const RigidTransform depth = TransformOf(rig.depth_from_polar[k]) * polar;
    cameras.push_back(PinholeOf("d" + std::to_string(k + 1), kDepthLens[k], 512, 424, depth));
  }
  for (int k = 0; k < 3; ++k) {
    const RigidTransform colour = TransformOf(rig.colour_from_depth[k]) * cameras[1 + k].camera_from_world;
    cameras.push_back(PinholeOf("c" + std::to_string(k + 1), kColourLens[k], 1920, 1080, colour));
  }
  return cameras;
}

Expected<std::string> EncodePhspdCalibration(const PhspdCalibration& calibration) {
  PickleWriter writer;
  writer.BeginDict();
  PutArray(writer, "scale", {}, {1.0});
  const RigidTransform polar = PhspdPolarFromWorld();
  for (int k = 1; k <= 3; ++k) {
    std::vector<double> boards;
    for (int b = -1; b <= 1; ++b) {
      const Vector3d board = polar * Vector3d(0.35 * b, 0.9 + 0.1 * k, 0.15 * b) / kPerMillimetre;
      boards.insert(boards.end(), {1.0, 0.0, 0.0, 0.0, board.x(), board.y(), board.z()});
    }
    PutArray(writer, "p" + std::to_string(k) + "w", {3, 7}, std::move(boards));
  }
  const auto put = [&](const std::string& key, const std::array<double, 7>& values) {
    PutArray(writer, key, {7}, std::vector<double>(values.begin(), values.end()));
  };
  for (int k = 0; k < 3; ++k) put("d" + std::to_string(k + 1) + "p", calibration.depth_from_polar[k]);
  for (int k = 0; k < 3; ++k) put("cd" + std::to_string(k + 1), calibration.colour_from_depth[k]);
  put("param_p", kPolar);
  for (int k = 0; k < 3; ++k) {
    put("param_c" + std::to_string(k + 1), kColourLens[k]);
    put("param_d" + std::to_string(k + 1), kDepthLens[k]);
  }
  writer.End();
  return writer.Finish(calibration.name);
}

std::vector<Camera> Human36mRig() {
  // Their world has z up and the subjects about (60, 320) mm from its origin.
  Matrix3d turn;
  turn << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  const RigidTransform room{Quaterniond(turn), Vector3d(0.060, 0.320, 0.0)};
  std::vector<Camera> cameras;
  for (const Human36mCamera& known : kHuman36m) {
    Matrix3d rotation;
    rotation << known.r[0], known.r[1], known.r[2], known.r[3], known.r[4], known.r[5], known.r[6], known.r[7],
        known.r[8];
    const RigidTransform pose{Quaterniond(rotation).normalized(),
                              kPerMillimetre * Vector3d(known.t[0], known.t[1], known.t[2])};
    cameras.push_back(PinholeOf(known.name, known.pinhole, 1000, known.height, pose * room));
    cameras.back().distortion = known.lens;
  }
  return cameras;
}

std::vector<Camera> RingRig(const RigOptions& options, SensorKind sensor) {
  const bool is_depth = sensor == SensorKind::kDepth;
  std::vector<Camera> cameras;
  for (std::int64_t k = 0; k < options.cameras; ++k) {
    const double angle = 2.0 * kPi * static_cast<double>(k) / static_cast<double>(options.cameras);
    const Vector3d centre(options.radius * std::sin(angle), options.height, options.radius * std::cos(angle));
    const Vector3d forward = (Vector3d(0.0, 1.0, 0.0) - centre).normalized();
    const Vector3d right = forward.cross(Vector3d::UnitY()).normalized();
    Matrix3d rotation;  // rows: x right, y down, z forward
    rotation.row(0) = right;
    rotation.row(1) = forward.cross(right);
    rotation.row(2) = forward;
    Camera camera;
    camera.name = "cam" + ZeroPadded(static_cast<int>(k + 1), 2);
    camera.width = options.width > 0 ? static_cast<int>(options.width) : is_depth ? 512 : 1280;
    camera.height = options.height_px > 0 ? static_cast<int>(options.height_px) : is_depth ? 424 : 960;
    camera.fx = camera.fy = options.focal_px > 0.0 ? options.focal_px : is_depth ? 365.0 : 1150.0;
    camera.cx = 0.5 * (camera.width - 1);
    camera.cy = 0.5 * (camera.height - 1);
    camera.camera_from_world.rotation = Quaterniond(rotation).normalized();
    camera.camera_from_world.translation = -(camera.camera_from_world.rotation * centre);
    cameras.push_back(camera);
  }
  return cameras;
}

std::vector<Camera> RigOf(const RigOptions& options, SensorKind sensor) {
  const std::vector<Camera> phspd = PhspdRig(1);
  const bool is_depth = sensor == SensorKind::kDepth;
  const auto first = phspd.begin() + (is_depth ? 1 : 4);
  if (options.kind == RigKind::kPhspd || (options.kind == RigKind::kOwn && is_depth)) return {first, first + 3};
  if (options.kind == RigKind::kHuman36m) return Human36mRig();
  return RingRig(options, sensor);
}

RigFaults FaultsOf(const RigOptions& options, const std::vector<Camera>& calibrated, std::int64_t seed) {
  RigFaults faults{std::vector<double>(calibrated.size(), 0.0), calibrated};
  Random clock(static_cast<std::uint64_t>(seed), "studio.clock");
  for (std::size_t k = 1; k < calibrated.size() && options.clock_offset_s > 0.0; ++k) {
    faults.clock_s[k] = clock.Uniform(-options.clock_offset_s, options.clock_offset_s);
  }
  if (options.moved > 0.0 && !calibrated.empty()) {
    Random random(static_cast<std::uint64_t>(seed), "studio.moved");
    const double way = random.Uniform(0.0, 2.0 * kPi);
    // Shifted sideways and slightly rotated: a tripod that was knocked.
    const RigidTransform knock{ExpQuaternion(0.3 * options.moved * Vector3d(random.Normal(), random.Normal(), 0.0)),
                               options.moved * Vector3d(std::cos(way), 0.0, std::sin(way))};
    faults.real.back().camera_from_world = knock * faults.real.back().camera_from_world;
  }
  return faults;
}

}  // namespace mocurate
