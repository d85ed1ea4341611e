// Recorded depth images lie on the person or the body.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/body/skinned_body.h"
#include "core/formats/camera_files.h"
#include "core/formats/png.h"
#include "core/formats/point_cloud.h"
#include "core/store/body_file.h"
#include "ingest/inspect/calibration_estimate.h"
#include "tests/formats/damage.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/jpeg_masks.h"
#include "tests/support/point_grid.h"

namespace mocurate {
namespace {

using Json = nlohmann::json;
using test::RecordedFile;

class RecordedDepth : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("MOCURATE_DATA") == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }
};

double MedianOfPixels(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

double Rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

Expected<CalibratedView> ReadView(const std::string& file) {
  const auto calibration = ParseOpenCvCalibration({{"camera.xml", RecordedFile(file)}});
  if (!calibration) return Forward(calibration);
  return calibration->views.at(0);
}

/// The masked person of one view, in the camera frame.
struct ViewCloud {
  std::size_t view = 0;  ///< of the calibration
  std::vector<Vector3d> points;
};

/// All recorded views.
struct Turntable {
  Calibration calibration;
  std::vector<ViewCloud> clouds;
};

Turntable ReadTurntable(int step) {
  Turntable set;
  set.calibration.dialect = "opencv_view";
  for (int i = 0; i < 100; i += step) {
    if (i % 5 == 2) continue;
    char number[16];
    std::snprintf(number, sizeof number, "%010d", i);
    const std::string stem = "rgbd100/views/" + std::string(number);
    const auto view = ReadView(stem + "_camera.xml");
    EXPECT_TRUE(view) << view.error().Message();
    const auto depth = DecodeDepthPng(RecordedFile(stem + "_depth.png"), "depth.png");
    const PixelMask mask = test::JpegMask(RecordedFile(stem + "_mask.jpg"));
    EXPECT_TRUE(depth);
    if (!view || !depth) return set;
    const Camera camera = CameraOf(*view, PoseConvention::kWorldToCamera, 1.0);
    set.clouds.push_back({set.calibration.views.size(), BackProject(*depth, camera, 0.001, &mask)});
    set.calibration.views.push_back(*view);
  }
  return set;
}

TEST_F(RecordedDepth, EstimatesTurntablePosesAsCameraToWorld) {
  const Turntable set = ReadTurntable(4);
  ASSERT_EQ(set.clouds.size(), 20u);
  EXPECT_NEAR(static_cast<double>(set.clouds[0].points.size()), 55'000, 15'000);
  const CalibrationEstimate estimate = EstimateCalibration(set.calibration);
  EXPECT_EQ(estimate.reading.value, "camera_to_world") << estimate.reading.evidence;
  EXPECT_GT(estimate.reading.confidence, 0.99);
  EXPECT_EQ(estimate.unit.value, "m") << estimate.unit.evidence;
  EXPECT_EQ(estimate.up.value, "-y");
}

TEST_F(RecordedDepth, AlignsEveryTurntableViewWithTheOthers) {
  const Turntable set = ReadTurntable(1);
  ASSERT_EQ(set.clouds.size(), 80u);
  std::vector<std::vector<Vector3d>> worlds;
  std::vector<Vector3d> all;
  std::vector<int> view_of;
  for (const ViewCloud& cloud : set.clouds) {
    const RigidTransform world_from_camera =
        Inverse(CameraOf(set.calibration.views[cloud.view], PoseConvention::kCameraToWorld, 1.0).camera_from_world);
    worlds.emplace_back();
    for (std::size_t i = 0; i < cloud.points.size(); i += 7) {
      worlds.back().push_back(world_from_camera * cloud.points[i]);
    }
  }
  std::vector<double> rms;
  double worst_clipped = 0.0;
  // Every eighth view against the union of the others; all views would take too long.
  for (std::size_t v = 0; v < worlds.size(); v += 8) {
    std::vector<Vector3d> others;
    for (std::size_t o = 0; o < worlds.size(); ++o) {
      if (o != v) others.insert(others.end(), worlds[o].begin(), worlds[o].end());
    }
    const PointGrid grid(std::move(others), 0.003);
    std::vector<double> distances;
    for (const Vector3d& point : worlds[v]) distances.push_back(grid.Distance(point, 0.03));
    rms.push_back(Rms(distances));
    worst_clipped = std::max(worst_clipped, rms.back());
  }
  EXPECT_LE(MedianOfPixels(rms), 1.6e-3);
  EXPECT_GT(MedianOfPixels(rms), 0.8e-3);
  EXPECT_LE(worst_clipped, 2.5e-3);
}

TEST_F(RecordedDepth, MatchesTheCloudFileWithTheMaskedPixels) {
  const std::string stem = "rgbd100/views/0000000050";
  const auto view = ReadView(stem + "_camera.xml");
  const auto depth = DecodeDepthPng(RecordedFile(stem + "_depth.png"), "depth.png");
  const PixelMask mask = test::JpegMask(RecordedFile(stem + "_mask.jpg"));
  const auto pcd = ParsePcd(RecordedFile(stem + ".pcd"), "50.pcd");
  ASSERT_TRUE(view && depth && pcd);
  const PointGrid own(BackProject(*depth, CameraOf(*view, PoseConvention::kWorldToCamera, 1.0), 0.001, &mask), 0.005);
  int same = 0;
  const auto points = PcdPoints(*pcd, "50.pcd");
  for (const Vector3d& point : *points) same += own.Distance(point, 0.002) < 0.001 ? 1 : 0;
  EXPECT_GT(same, 61'000);
}

/// Exact distances to a mesh, limited to triangles with near centres.
class Surface {
 public:
  Surface(const RestBody& body, const std::vector<std::array<int, 3>>& faces)
      : vertices_(body.vertices), faces_(faces), centres_(Centres(body, faces)), grid_(centres_, 0.02) {
    for (std::size_t f = 0; f < faces.size(); ++f) {
      for (const int corner : faces[f]) largest_ = std::max(largest_, (vertices_[corner] - centres_[f]).norm());
    }
  }

  double Distance(const Vector3d& point) const {
    const int first = grid_.Nearest(point, 0.1);
    if (first < 0) return 0.1;
    double best = ToTriangle(point, faces_[static_cast<std::size_t>(first)]);
    const double reach = best + largest_;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if ((centres_[f] - point).squaredNorm() < reach * reach) best = std::min(best, ToTriangle(point, faces_[f]));
    }
    return best;
  }

 private:
  static std::vector<Vector3d> Centres(const RestBody& body, const std::vector<std::array<int, 3>>& faces) {
    std::vector<Vector3d> centres;
    for (const auto& face : faces) {
      centres.emplace_back((body.vertices[face[0]] + body.vertices[face[1]] + body.vertices[face[2]]) / 3.0);
    }
    return centres;
  }

  double ToTriangle(const Vector3d& p, const std::array<int, 3>& face) const {
    const Vector3d &a = vertices_[face[0]], &b = vertices_[face[1]], &c = vertices_[face[2]];
    const Vector3d normal = (b - a).cross(c - a);
    const double area = normal.squaredNorm();
    if (area > 0.0) {
      const double u = (b - p).cross(c - p).dot(normal) / area;
      const double v = (c - p).cross(a - p).dot(normal) / area;
      if (u >= 0 && v >= 0 && u + v <= 1) return std::abs((p - a).dot(normal)) / std::sqrt(area);
    }
    const auto to_edge = [&](const Vector3d& from, const Vector3d& to) {
      const Vector3d along = to - from;
      const double t = std::clamp((p - from).dot(along) / std::max(along.squaredNorm(), 1e-30), 0.0, 1.0);
      return (p - from - t * along).norm();
    };
    return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
  }

  const std::vector<Vector3d>& vertices_;
  const std::vector<std::array<int, 3>>& faces_;
  std::vector<Vector3d> centres_;
  PointGrid grid_;
  double largest_ = 0.0;
};

TEST_F(RecordedDepth, PlacesNoiseFreeRenderingsOnThePosedBody) {
  const auto body = ReadBodyTemplate(std::filesystem::path(std::getenv("MOCURATE_DATA")) / "body_cc0" / "body_cc0.h5");
  ASSERT_TRUE(body) << body.error().Message();
  for (const std::string name : {"male_tpose", "male_wave", "female_squat", "child_arms_down"}) {
    const Json truth = Json::parse(RecordedFile("clouds/rendered_body/" + name + ".json"));
    std::vector<Quaterniond> rotations;
    for (const Json& r : truth["rotvec24"]) rotations.push_back(ExpQuaternion(Vector3d(r[0], r[1], r[2])));
    const Json& t = truth["translation_added"];
    const RestBody posed = Posed(*body, body->variants.at(truth["body"]), rotations, Vector3d(t[0], t[1], t[2]));
    for (std::size_t j = 0; j < 24; ++j) {
      const Json& joint = truth["joints_m"][j];
      EXPECT_LT((posed.joints[j] - Vector3d(joint[0], joint[1], joint[2])).norm(), 1e-5) << name << " " << j;
    }
    const Surface surface(posed, body->faces);
    std::vector<double> distances;
    for (const auto& item : truth["views"].items()) {
      const Json& given = item.value();
      CalibratedView view;
      view.fx = given["fx_fy_cx_cy"][0], view.fy = given["fx_fy_cx_cy"][1];
      view.cx = given["fx_fy_cx_cy"][2], view.cy = given["fx_fy_cx_cy"][3];
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) view.rotation(r, c) = given["R_p_to_d"][r][c];
        view.translation[r] = given["t_m"][r];
      }
      const Camera camera = CameraOf(view, PoseConvention::kWorldToCamera, 1.0);
      const auto depth = DecodeDepthPng(RecordedFile("clouds/rendered_body/" + given["file"].get<std::string>()), "d");
      ASSERT_TRUE(depth) << depth.error().Message();
      const RigidTransform world_from_camera = Inverse(camera.camera_from_world);
      const std::vector<Vector3d> points = BackProject(*depth, camera, 0.001);
      EXPECT_EQ(points.size(), given["pixels"].get<std::size_t>());
      for (std::size_t i = 0; i < points.size(); i += 40)
        distances.push_back(surface.Distance(world_from_camera * points[i]));
    }
    EXPECT_LE(Rms(distances), 0.7e-3) << name;
    EXPECT_LE(*std::max_element(distances.begin(), distances.end()), 2.1e-3) << name;
    EXPECT_GT(Rms(distances), 0.2e-3) << name;
  }
}

TEST_F(RecordedDepth, MatchesTheHeightsOfTheTemplateBodies) {
  const std::filesystem::path file = std::filesystem::path(std::getenv("MOCURATE_DATA")) / "body_cc0" / "body_cc0.h5";
  const auto body = ReadBodyTemplate(file);
  ASSERT_TRUE(body) << body.error().Message();
  for (const auto& [name, height] : {std::pair{"male", 1.737}, {"female", 1.595}, {"child", 1.366}}) {
    double low = 1.0, high = -1.0;
    for (const Vector3d& v : body->variants.at(name).vertices) low = std::min(low, v.y()), high = std::max(high, v.y());
    EXPECT_NEAR(high - low, height, 6e-4) << name;
  }
  // Gender -1 is exactly the male, with the pelvis at the origin.
  const RestBody male = Shaped(*body, {-1.0});
  const RestBody& given = body->variants.at("male");
  for (std::size_t v = 0; v < male.vertices.size(); v += 100) {
    EXPECT_LT((male.vertices[v] - (given.vertices[v] - given.joints[0])).norm(), 1e-5);
  }
  ExpectError(ReadBodyTemplate("nowhere.h5"), ErrorCode::kNotFound, "nowhere.h5");
}

}  // namespace
}  // namespace mocurate
