// A published calibration: its rotation vectors and matrices agree through our exponential.
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/geometry/camera.h"
#include "tests/geometry/samples.h"

namespace mocurate {
namespace {

TEST(Calibration, OfAPublishedRigIsReadAsRigidCamerasAroundTheSubject) {
  const char* folder = std::getenv("MOCURATE_DATA");
  if (folder == nullptr) GTEST_SKIP() << "MOCURATE_DATA (folder of the test data) is not set";
  std::ifstream stream(std::string(folder) + "/pose2sim/calib_converted.json");
  ASSERT_TRUE(stream.good());
  const nlohmann::json rig = nlohmann::json::parse(stream);
  ASSERT_EQ(rig["cameras"].size(), 4u);
  for (const nlohmann::json& entry : rig["cameras"]) {
    Matrix3d given;
    Vector3d rotation_vector;
    Camera camera;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) given(row, column) = entry["R"][row][column];
      rotation_vector[row] = entry["rvec"][row];
      camera.camera_from_world.translation[row] = entry["t"][row];
    }
    EXPECT_LT(test::Difference(ExpMatrix(rotation_vector), given), 1e-14) << entry["name"];
    EXPECT_LT(test::Difference(LogMatrix(given), rotation_vector), 1e-14) << entry["name"];
    camera.camera_from_world.rotation = ExpQuaternion(rotation_vector);
    camera.width = entry["size"][0];
    camera.height = entry["size"][1];
    camera.fx = entry["K"][0][0];
    camera.fy = entry["K"][1][1];
    camera.cx = entry["K"][0][2];
    camera.cy = entry["K"][1][2];
    const nlohmann::json& d = entry["dist_k1k2p1p2k3"];
    camera.distortion = {d[0], d[1], d[2], d[3], d[4]};
    const Vector3d point = camera.Unproject(Vector2d(17.0, 1900.0), 4.0);
    EXPECT_LT(test::Difference(camera.Project(point).value(), Vector2d(17.0, 1900.0)), 1e-9);
    EXPECT_LT(camera.Centre().norm(), 10.0);
  }
}

}  // namespace
}  // namespace mocurate
