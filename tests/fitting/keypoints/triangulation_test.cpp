#include "fitting/triangulation/robust_triangulation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/base/file.h"
#include "core/base/random.h"
#include "core/formats/camera_files.h"
#include "core/formats/openpose.h"
#include "fitting/triangulation/normal_equations3.h"

namespace mocurate {
namespace {

/// N cameras around the origin, 4 m away, looking at it; lens distortion in every second one.
std::vector<Camera> DistortedRing(int count) {
  std::vector<Camera> cameras;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * EIGEN_PI * i / count;
    const Vector3d centre(4.0 * std::sin(angle), 1.2 + 0.4 * (i % 3), 4.0 * std::cos(angle));
    Matrix3d rows;  // camera axes in the world: x right, y down, z forward
    const Vector3d forward = (Vector3d(0, 1, 0) - centre).normalized();
    const Vector3d right = forward.cross(Vector3d::UnitY()).normalized();
    rows << right.transpose(), forward.cross(right).transpose(), forward.transpose();
    Camera camera;
    camera.width = 1920;
    camera.height = 1080;
    camera.fx = camera.fy = 1400;
    camera.cx = 960;
    camera.cy = 540;
    if (i % 2 == 1) camera.distortion = {-0.1, 0.03, 0.001, -0.0005, 0.0};
    camera.camera_from_world.rotation = Quaterniond(rows);
    camera.camera_from_world.translation = -(camera.camera_from_world.rotation * centre);
    cameras.push_back(camera);
  }
  return cameras;
}

struct ObservedPoint {
  std::vector<TriangulationView> views;
  std::vector<ViewRay> rays;
  Vector3d truth;
};

/// A point near the origin observed by all cameras with noise of `sigma` px; the views of `wrong` are 200 to 400 px
/// off.
ObservedPoint ObservePoint(int cameras, double sigma, const std::vector<int>& wrong, std::uint64_t seed) {
  ObservedPoint scene;
  Random random(seed, "scene");
  scene.truth = Vector3d(random.Uniform(-0.5, 0.5), random.Uniform(0.2, 1.8), random.Uniform(-0.5, 0.5));
  for (const Camera& camera : DistortedRing(cameras)) scene.views.emplace_back(camera);
  for (int i = 0; i < cameras; ++i) {
    Vector2d pixel = *scene.views[i].camera.ProjectWorld(scene.truth);
    pixel += sigma * Vector2d(random.Normal(), random.Normal());
    if (std::find(wrong.begin(), wrong.end(), i) != wrong.end()) {
      const double angle = random.Uniform(0.0, 6.28);
      pixel += random.Uniform(200, 400) * Vector2d(std::cos(angle), std::sin(angle));
    }
    scene.rays.emplace_back(scene.views[i], i, scene.views[i].camera.Unproject(pixel, 1.0).head<2>(), 1.0);
  }
  return scene;
}

TEST(TriangulateRobust, FindsAPointExactlyWithoutNoise) {
  for (const int cameras : {2, 3, 4, 8, 32}) {
    const ObservedPoint scene = ObservePoint(cameras, 0.0, {}, cameras);
    const auto point = TriangulateRobust(scene.rays, {});
    ASSERT_TRUE(point) << cameras;
    EXPECT_LT((point->position - scene.truth).norm(), 1e-6);
    EXPECT_EQ(point->view_count, cameras);
    EXPECT_LT(point->error_px, 1e-3);
  }
}

TEST(TriangulateRobust, ExcludesWrongViews) {
  struct Case {
    int cameras;
    std::vector<int> wrong;
  };
  for (const Case& test : {Case{4, {1}}, Case{5, {0, 3}}, Case{8, {2, 5, 6}}, Case{16, {0, 1, 2, 3, 4}},
                           Case{32, {3, 4, 9, 11, 17, 20, 25, 28, 31}}}) {
    int right = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
      const ObservedPoint scene = ObservePoint(test.cameras, 2.0, test.wrong, seed);
      const auto point = TriangulateRobust(scene.rays, {});
      if (!point || (point->position - scene.truth).norm() > 0.03) continue;
      bool clean = true;
      for (const int view : test.wrong) clean = clean && (point->views >> static_cast<unsigned>(view) & 1U) == 0;
      right += clean ? 1 : 0;
    }
    EXPECT_GE(right, 195) << test.cameras << " cameras, " << test.wrong.size() << " wrong";
  }
}

TEST(TriangulateRobust, ReturnsNoPointWhereNoMajorityAgrees) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    found += TriangulateRobust(ObservePoint(4, 1.0, {0, 2}, seed).rays, {}) ? 1 : 0;
  }
  EXPECT_LE(found, 5);
  EXPECT_FALSE(TriangulateRobust({}, {}));
  ObservedPoint scene = ObservePoint(4, 0.0, {}, 1);
  scene.rays.erase(scene.rays.begin() + 1, scene.rays.end());
  EXPECT_FALSE(TriangulateRobust(scene.rays, {}));
}

TEST(TriangulateRobust, StatesACovarianceThatCoversItsErrors) {
  int within_one = 0;
  int within_two = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const ObservedPoint scene = ObservePoint(4, 4.0, {}, seed);
    const auto point = TriangulateRobust(scene.rays, {});
    if (!point) continue;
    const Eigen::LLT<Matrix3d> root(point->covariance);
    const Vector3d white = root.matrixL().solve(Vector3d(point->position - scene.truth));
    within_one += static_cast<int>((white.array().abs() < 1.0).count());
    within_two += static_cast<int>((white.array().abs() < 2.0).count());
    count += 3;
  }
  ASSERT_GT(count, 1400);
  EXPECT_NEAR(static_cast<double>(within_one) / count, 0.683, 0.03);
  EXPECT_NEAR(static_cast<double>(within_two) / count, 0.954, 0.02);
}

/// The trial's subject: the most confident person of each image.
std::vector<ViewKeypoints> ReadTrial(const std::filesystem::path& rig, const std::string& trial, int& frames) {
  const auto calibration = ParseCalibration(*ReadFile(rig / "calib_converted.json"), "calib_converted.json");
  EXPECT_TRUE(calibration) << calibration.error().Message();
  std::vector<ViewKeypoints> views;
  for (std::size_t c = 0; c < calibration->views.size(); ++c) {
    ViewKeypoints view;
    view.camera = CameraOf(calibration->views[c], PoseConvention::kWorldToCamera, 1.0);
    std::vector<std::filesystem::path> files;
    for (const auto& entry :
         std::filesystem::directory_iterator(rig / trial / ("cam0" + std::to_string(c + 1) + "_json"))) {
      files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    frames = static_cast<int>(files.size());
    for (const auto& file : files) {
      const auto frame = ParseOpenPose(*ReadFile(file), file.filename().string());
      EXPECT_TRUE(frame) << frame.error().Message();
      const auto confidence = [](const OpenPosePerson& person) {
        double sum = 0.0;
        for (const DetectedKeypoint& point : person.pose) sum += point.confidence;
        return sum;
      };
      const auto subject =
          std::max_element(frame->people.begin(), frame->people.end(),
                           [&](const auto& a, const auto& b) { return confidence(a) < confidence(b); });
      for (const DetectedKeypoint& point : subject->pose) {
        view.normalised.emplace_back(view.camera.Unproject(Vector2d(point.u_px, point.v_px), 1.0).head<2>());
        view.confidence.push_back(point.confidence);
      }
    }
    views.push_back(std::move(view));
  }
  return views;
}

TEST(TriangulateViews, FindsThePersonOfARecordedTrialAndTheCameraThatDisagrees) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  int frames = 0;
  const auto views = ReadTrial(std::filesystem::path(data) / "pose2sim", "single", frames);
  const TriangulatedTracks tracks = TriangulateViews(views, frames, 25, {});
  std::vector<double> errors;
  int found = 0;
  int limbs = 0;
  for (std::size_t i = 0; i < tracks.confidence.size(); ++i) {
    if (tracks.confidence[i] == 0.0) continue;
    ++found;
    errors.push_back(tracks.error_px[i]);
    const std::size_t point = i % 25;
    limbs += point >= 5 && point <= 18 && point != 9 && point != 10 ? 1 : 0;
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LE(errors[errors.size() / 2], 8.5);
  EXPECT_LE(errors[errors.size() * 9 / 10], 17.0);
  EXPECT_GE(found, 0.79 * 25 * frames);
  EXPECT_GE(limbs, 0.97 * 12 * frames);
  for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(tracks.cameras[c].disagrees, c == 2) << "camera " << c + 1;
}

TEST(NormalEquations3, SolveLikeADenseFactorisation) {
  Random random(5, "equations");
  const auto draw = [&] { return Vector3d(random.Normal(), random.Normal(), random.Normal()); };
  NormalEquations3 equations;
  Matrix3d matrix = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  Vector3d solution;
  EXPECT_FALSE(equations.Solve(solution)) << "no observation was added";
  for (int i = 0; i < 3; ++i) {
    const Vector3d slope = draw(), direction = draw().normalized(), origin = draw();
    equations.Add(0.3 + i, slope, 0.7 * i);
    matrix += (0.3 + i) * slope * slope.transpose();
    right += (0.3 + i) * 0.7 * i * slope;
    const Matrix3d across = (1.0 + i) * (Matrix3d::Identity() - direction * direction.transpose());
    equations.AddAcross(1.0 + i, direction, origin);
    matrix += across;
    right += across * origin;
  }
  ASSERT_TRUE(equations.Solve(solution));
  EXPECT_LT((matrix * solution - right).norm(), 1e-12);
  EXPECT_LT((equations.Matrix() - matrix).norm(), 1e-12);
}

}  // namespace
}  // namespace mocurate
