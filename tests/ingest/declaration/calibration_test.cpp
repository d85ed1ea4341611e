// Calibrations and depth views of rigs: the convention of R and t and the unit are estimated, and depth lies on the
// body.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/formats/camera_files.h"
#include "core/formats/panoptic_bodies.h"
#include "ingest/inspect/calibration_estimate.h"
#include "tests/formats/damage.h"
#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

Calibration Recorded(const std::string& path) {
  const auto calibration = ParseCalibration(test::RecordedFile(path), path);
  EXPECT_TRUE(calibration) << calibration.error().Message();
  return calibration.value_or(Calibration{});
}

void ExpectEstimate(const Calibration& calibration, const std::string& reading, const std::string& unit,
                    const std::string& up) {
  const CalibrationEstimate estimate = EstimateCalibration(calibration);
  EXPECT_EQ(estimate.reading.value, reading) << estimate.reading.confidence << " " << estimate.reading.evidence;
  EXPECT_EQ(estimate.unit.value, unit) << estimate.unit.confidence << " " << estimate.unit.evidence;
  EXPECT_EQ(estimate.up.value, up) << estimate.up.evidence;
  EXPECT_TRUE(estimate.remarks.empty());
  EXPECT_EQ(estimate.cameras.size(), reading.empty() || unit.empty() ? 0u : calibration.views.size());
}

Expected<Calibration> ReadRig(const std::string& intrinsic, const std::string& extrinsic) {
  return ParseOpenCvCalibration({{"intri.yml", intrinsic}, {"extri.yml", extrinsic}});
}

class RecordedRigs : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("MOCURATE_DATA") == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  }
};

TEST_F(RecordedRigs, EstimateTheirConvention) {
  ExpectEstimate(Recorded("cameras/human36m/camera-parameters.json"), "world_to_camera", "mm", "+z");
  ExpectEstimate(Recorded("cameras/campus_shelf/calibration_campus.json"), "centre", "mm", "+z");
  ExpectEstimate(Recorded("cameras/campus_shelf/calibration_shelf.json"), "centre", "mm", "+z");
  ExpectEstimate(Recorded("cameras/panoptic/calibration_160906_band1.json"), "world_to_camera", "cm", "-y");
  ExpectEstimate(Recorded("pose2sim/Calib.qca.txt"), "centre", "mm", "+z");
  ExpectEstimate(Recorded("pose2sim/Calib_converted.toml"), "world_to_camera", "m", "+z");
  ExpectEstimate(Recorded("pose2sim/calib_converted.json"), "world_to_camera", "m", "+z");
}

TEST_F(RecordedRigs, EstimateThePhspdConventionOnlyWithItsBoards) {
  Calibration rigs = Recorded("cameras/phspd/phspd_rigs.json");
  ExpectEstimate(rigs, "world_to_camera", "mm", "-y");
  rigs.subject_points.clear();
  const CalibrationEstimate estimate = EstimateCalibration(rigs);
  EXPECT_EQ(estimate.reading.value, "") << estimate.reading.confidence << " " << estimate.reading.evidence;
  EXPECT_TRUE(estimate.cameras.empty());
}

TEST_F(RecordedRigs, ReadOpenCvRigsAndProjectLikePose2Sim) {
  const auto folder = [](const std::string& name) {
    return ReadRig(test::RecordedFile("cameras/" + name + "/intri.yml"),
                   test::RecordedFile("cameras/" + name + "/extri.yml"));
  };
  const auto easymocap = folder("easymocap");
  ASSERT_TRUE(easymocap) << easymocap.error().Message();
  EXPECT_EQ(easymocap->views.size(), 11u);
  EXPECT_EQ(easymocap->views[9].name, "7");
  ExpectEstimate(*easymocap, "world_to_camera", "m", "+z");
  const auto own = folder("opencv_yml");
  ASSERT_TRUE(own) << own.error().Message();
  const CalibrationEstimate estimate = EstimateCalibration(*own);
  const CalibrationEstimate truth = EstimateCalibration(Recorded("pose2sim/Calib.qca.txt"));
  ASSERT_EQ(estimate.cameras.size(), 4u);
  ASSERT_EQ(truth.cameras.size(), 4u);
  for (std::size_t c = 0; c < 4; ++c) {
    const Vector3d point(0.3, -0.4, 1.2);
    EXPECT_LT((*estimate.cameras[c].ProjectWorld(point) - *truth.cameras[c].ProjectWorld(point)).norm(), 1e-3);
  }
}

TEST_F(RecordedRigs, NameEveryDamagedNodeOfAnOpenCvFile) {
  const std::string intrinsic = test::RecordedFile("cameras/opencv_yml/intri.yml");
  const std::string extrinsic = test::RecordedFile("cameras/opencv_yml/extri.yml");
  for (const std::string key : {"K_cam01", "dist_cam02", "R_cam03", "T_cam04", "names"}) {
    std::string i = intrinsic;
    std::string e = extrinsic;
    std::string& damaged = key[0] == 'K' || key[0] == 'd' ? i : e;
    damaged.replace(damaged.find(key + ":"), 1, "Z");
    // The rig file also has Rot_ as a substitute for R_.
    if (key[0] == 'R') e.replace(e.find("Rot_cam03"), 1, "Z");
    ExpectMalformed(ReadRig(i, e), (&damaged == &i ? "intri.yml:" : "extri.yml:") + key);
  }
  std::string changed = extrinsic;
  const std::size_t data = changed.find("[", changed.find("R_cam01")) + 1;
  changed.replace(data, changed.find(',', data) - data, " 0.5");
  ExpectError(ReadRig(intrinsic, changed), ErrorCode::kInconsistent, "extri.yml");
  for (std::size_t size = 0; size < extrinsic.size() - 40; size += 97) {
    EXPECT_FALSE(ReadRig(intrinsic, extrinsic.substr(0, size))) << size;
  }
}

TEST_F(RecordedRigs, PlaceTheBandInFrontOfAllPanopticCameras) {
  const Calibration calibration = Recorded("cameras/panoptic/calibration_160906_band1.json");
  const CalibrationEstimate estimate = EstimateCalibration(calibration);
  ASSERT_EQ(estimate.cameras.size(), 520u);
  std::vector<Vector3d> joints;
  for (int f = 168; f <= 187; ++f) {
    const auto scene = ParsePanopticBodies(
        test::RecordedFile("cameras/panoptic/160906_band1/body3DScene_00000" + std::to_string(f) + ".json"), "b");
    ASSERT_TRUE(scene);
    for (const PanopticBody& body : scene->bodies) {
      for (std::size_t j = 0; j < body.confidence.size(); ++j) {
        if (body.confidence[j] >= 0) joints.push_back(0.01 * body.position_cm[j]);
      }
    }
  }
  double inside = 0.0;
  double least = 1.0;
  int hd = 0;
  for (std::size_t c = 0; c < estimate.cameras.size(); ++c) {
    if (calibration.views[c].kind != "hd") continue;
    ++hd;
    double own = 0.0;
    for (const Vector3d& joint : joints) {
      const auto pixel = estimate.cameras[c].ProjectWorld(joint);
      ASSERT_TRUE(pixel) << estimate.cameras[c].name;
      own += pixel->x() >= 0 && pixel->x() < 1920 && pixel->y() >= 0 && pixel->y() < 1080 ? 1.0 : 0.0;
    }
    own /= static_cast<double>(joints.size());
    inside += own;
    least = std::min(least, own);
  }
  EXPECT_EQ(hd, 31);
  EXPECT_NEAR(inside / hd, 0.876, 0.002);
  EXPECT_GT(least, 0.655);
}

/// Cameras around a point at this distance.
Calibration RingAt(double distance) {
  Calibration ring;
  for (int i = 0; i < 5; ++i) {
    CalibratedView view;
    view.name = "cam" + std::to_string(i);
    view.fx = view.fy = 1000, view.cx = 500, view.cy = 500;
    view.rotation = ExpMatrix(Vector3d(0, 0.9 * i, 0));
    view.translation = Vector3d(0, 0, distance) - view.rotation * Vector3d(0.3, 0.2, 0.1) * distance;
    ring.views.push_back(view);
  }
  return ring;
}

TEST(CalibrationEstimate, LeavesInchesUnknown) {
  EXPECT_EQ(EstimateCalibration(RingAt(3.5)).unit.value, "m");
  EXPECT_EQ(EstimateCalibration(RingAt(300.0)).unit.value, "cm");
  const CalibrationEstimate inches = EstimateCalibration(RingAt(138.0));
  EXPECT_EQ(inches.unit.value, "") << inches.unit.evidence;
}

TEST(CalibrationEstimate, ReportsImplausibleCameraParameters) {
  Calibration millimetres = RingAt(3.5);
  millimetres.views[2].fx = millimetres.views[2].fy = 1.0;
  const CalibrationEstimate focal = EstimateCalibration(millimetres);
  ASSERT_EQ(focal.remarks.size(), 1u);
  EXPECT_EQ(focal.remarks[0].code, "calibration_contradiction");
  EXPECT_EQ(focal.remarks[0].value, 1.0);
  Calibration backwards = RingAt(3.5);
  for (CalibratedView& view : backwards.views) view.translation = -view.translation;
  const CalibrationEstimate behind = EstimateCalibration(backwards);
  EXPECT_EQ(behind.reading.value, "") << behind.reading.evidence;
  ASSERT_FALSE(behind.remarks.empty());
  EXPECT_EQ(behind.remarks[0].code, "calibration_contradiction");
  EXPECT_TRUE(behind.cameras.empty());
}

TEST(CalibrationEstimate, IsUnknownWhenTheEvidenceConflicts) {
  // Parallel optical axes do not intersect.
  Calibration parallel;
  parallel.views.resize(3);
  for (int i = 0; i < 3; ++i) {
    CalibratedView& view = parallel.views[i];
    view.fx = view.fy = 1000, view.cx = 500, view.cy = 500;
    view.translation = Vector3d(i, 0, 0);
  }
  CalibrationEstimate estimate = EstimateCalibration(parallel);
  EXPECT_EQ(estimate.reading.value, "");
  EXPECT_NEAR(estimate.reading.confidence, 1.0 / 3.0, 1e-9);
  EXPECT_TRUE(estimate.cameras.empty());
  // A ring of 1000 units may be 10 m in centimetres or 1 m in millimetres.
  Calibration ring;
  for (int i = 0; i < 5; ++i) {
    CalibratedView view = parallel.views[0];
    view.rotation = ExpMatrix(Vector3d(0, 0.9 * i, 0));
    view.translation = Vector3d(0, 0, 1000) - view.rotation * Vector3d(300, 200, 100);
    ring.views.push_back(view);
  }
  estimate = EstimateCalibration(ring);
  EXPECT_EQ(estimate.reading.value, "world_to_camera") << estimate.reading.evidence;
  EXPECT_EQ(estimate.unit.value, "") << estimate.unit.evidence;
  EXPECT_TRUE(estimate.cameras.empty());
  // The declared convention is kept, and the contradictory estimate is reported.
  ring.reading = PoseConvention::kCameraToWorld;
  ring.metres_per_unit = 1.0;
  estimate = EstimateCalibration(ring);
  EXPECT_EQ(estimate.reading.value, "camera_to_world");
  ASSERT_FALSE(estimate.remarks.empty());
  EXPECT_EQ(estimate.remarks[0].code, "calibration_contradiction");
}

}  // namespace
}  // namespace mocurate
