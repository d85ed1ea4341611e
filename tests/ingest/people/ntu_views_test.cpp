// Three Kinects of one performance become one clip: poses, clock offsets and identities are estimated from the
// tracks. The ground truth is synthetic.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/formats/ntu_skeleton.h"
#include "core/formats/png.h"
#include "ingest/checks/clip_checks.h"
#include "ingest/synthetic/body_points.h"
#include "ingest/synthetic/rigs.h"
#include "tests/formats/expect_error.h"
#include "tests/ingest/studio_folders.h"

namespace mocurate {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

namespace fs = std::filesystem;

constexpr const char* kCapture = "S001P001R001A007";

/// Sensor axes (x left, y up, z away) -> canonical.
const RigidTransform kCanonicalFromSensor{Quaterniond(0.0, 0.0, 1.0, 0.0), Vector3d::Zero()};

std::string FileOf(int camera, const std::string& rest = "P001R001A007") {
  return "nturgb+d_skeletons/S001C00" + std::to_string(camera) + rest + ".skeleton";
}

class NtuViews : public Layouts {
 protected:
  StudioOptions Throw() {
    StudioOptions options = Perfect(StudioLayout::kNtu);
    options.subjects = 1;
    options.actions = {"throw"};
    return options;
  }

  /// Transforms from each camera to camera 1, from the synthetic poses without clock offsets.
  std::vector<RigidTransform> TrueExtrinsics(StudioOptions options) {
    options.rig.clock_offset_s = 0.0;
    options.depth.enabled = false;
    const auto written = WriteStudioLayout(options, folder / "places", 2);
    EXPECT_TRUE(written);
    std::vector<RigidTransform> first_from_camera;
    const std::map<std::string, Motion> motions = TruthOf(folder / "places");
    const auto joints = [&](int camera) {
      for (const auto& [id, motion] : motions) {
        if (id.find("C00" + std::to_string(camera)) == std::string::npos) continue;
        return Eigen::Matrix3Xd(Eigen::Map<const Eigen::Matrix3Xd>(motion.joints.xyz.data(), 3, motion.joints.frames));
      }
      return Eigen::Matrix3Xd();
    };
    for (int camera = 1; camera <= 3; ++camera) {
      const Eigen::Matrix3Xd from = joints(camera), to = joints(1);
      first_from_camera.push_back(AlignPoints(from, to, Eigen::VectorXd::Ones(from.cols())));
    }
    fs::remove_all(folder / "places");
    return first_from_camera;
  }

  IngestOptions Options() { return Declared("ntu_views", {"ingest.path=" + folder.string()}); }

  /// The only item, or the `index`-th.
  mocurate::Ingested Run(std::size_t index = 0) {
    const auto discovery = Discover(Options());
    EXPECT_TRUE(discovery) << discovery.error().Message();
    if (!discovery) return {tl::unexpected<Error>(discovery.error()), {}, {}};
    return RunIngest(discovery->items.at(index), "views");
  }

  NtuSkeleton Read(const std::string& name) { return *ParseNtuSkeleton(Bytes(name), name); }
  void Put(const std::string& name, const NtuSkeleton& skeleton) {
    mocurate::Put(folder / name, WriteNtuSkeleton(skeleton));
  }

  /// Values of the findings of a code.
  static std::vector<double> Found(const mocurate::Ingested& ingested, const std::string& code) {
    std::vector<double> values;
    for (const Finding& finding : ingested.outcome->findings) {
      if (finding.code == code) values.push_back(finding.value);
    }
    return values;
  }

  /// The true motion in the frame of camera 1.
  const Motion& TrueMotion() {
    return std::find_if(truth.begin(), truth.end(),
                        [](const auto& t) { return t.first.find("S001C001P001") != std::string::npos; })
        ->second;
  }

  /// Mean distance of the clip's joints from the ground truth.
  double ErrorOf(const Clip& clip) {
    const JointPositions places = PlacesOf(TrueMotion(), Kinect25Places());
    const auto first = clip.provenance.find("view.first_frame");
    const int begin = first == clip.provenance.end() ? 0 : std::stoi(first->second);
    double sum = 0.0;
    const JointPositions& measured = clip.evidence.tracks->positions;
    for (int f = 0; f < measured.frames; ++f) {
      for (int k = 0; k < measured.joints; ++k) sum += (measured.at(f, k) - places.at(begin + f, k)).norm();
    }
    return sum / (measured.frames * measured.joints);
  }
};

TEST_F(NtuViews, RecoverPosesClocksAndMotionOfTheSensors) {
  StudioOptions options = Throw();
  options.rig.clock_offset_s = 0.12;
  options.depth = DepthSensorOptions{true, false, 0, 0.001, 0, 0, 0, 0, 1};
  const std::vector<RigidTransform> places = TrueExtrinsics(options);
  const std::vector<double> clock_s = FaultsOf(options.rig, RingRig({}, SensorKind::kDepth), options.seed).clock_s;
  Write(options);
  const mocurate::Ingested ingested = Run();
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  const Clip& clip = ingested.clip;
  EXPECT_THAT(clip.id(), StartsWith(std::string("ntu_views/P001/") + kCapture + "#0-"));
  EXPECT_EQ(clip.identity.view, "C001+C002+C003");
  EXPECT_EQ(clip.provenance.at("view.reference"), "C001");
  ASSERT_EQ(clip.evidence.depth_views.size(), 3u);
  EXPECT_THAT(Found(ingested, "clock_offset"),
              ElementsAre(DoubleNear(1e3 * clock_s[1], 4.0), DoubleNear(1e3 * clock_s[2], 4.0)));
  for (int k = 1; k < 3; ++k) {
    const std::string key = "view.C00" + std::to_string(k + 1);
    const double offset_ms = std::stod(clip.provenance.at(key + ".offset_ms"));
    EXPECT_NEAR(offset_ms, 1e3 * clock_s[static_cast<std::size_t>(k)], 4.0) << key;
    EXPECT_LT(std::stod(clip.provenance.at(key + ".offset_sigma_ms")), 4.0);
    EXPECT_LT(std::stod(clip.provenance.at(key + ".disagreement_mm")), 5.0);
    // The camera in the world from the canonical frame of the sensor: 180 degrees about x.
    const Camera& camera = clip.evidence.depth_views[static_cast<std::size_t>(k)].camera;
    const RigidTransform camera_from_canonical{Quaterniond(0.0, 1.0, 0.0, 0.0), Vector3d::Zero()};
    const RigidTransform off =
        Inverse(camera.camera_from_world) * camera_from_canonical * Inverse(places[static_cast<std::size_t>(k)]);
    EXPECT_LT(off.translation.norm(), 0.02) << key;
    EXPECT_LT(AngleBetween(off.rotation, Quaterniond::Identity()), 0.006) << key;
    EXPECT_NEAR(camera.fx, -365.0, 0.5);
    EXPECT_NEAR(camera.cx, 255.5, 0.5);
  }
  EXPECT_LT(ErrorOf(clip), 0.004);
  // The measured depth must lie on the person, in the world frame and at the corrected time.
  const JointPositions& joints = clip.evidence.tracks->positions;
  const int frame = joints.frames / 2;
  for (const DepthView& view : clip.evidence.depth_views) {
    ASSERT_EQ(static_cast<int>(view.files.size()), joints.frames);
    EXPECT_LT(std::abs(view.time_s[static_cast<std::size_t>(frame)] - clip.rate.FrameTime(frame)), 0.0168);
    const std::string png = Bytes(view.files[static_cast<std::size_t>(frame)].string());
    const auto image = DecodeDepthPng(png, "depth");
    ASSERT_TRUE(image);
    const std::vector<Vector3d> cloud = BackProject(*image, view.camera, view.metres_per_unit);
    ASSERT_GT(cloud.size(), 1000u);
    double sum = 0.0;
    for (const Vector3d& point : cloud) {
      const Vector3d in_world = Inverse(view.camera.camera_from_world) * point;
      double nearest = 1e9;
      for (int k = 0; k < joints.joints; ++k) nearest = std::min(nearest, (in_world - joints.at(frame, k)).norm());
      sum += nearest;
    }
    EXPECT_LT(sum / static_cast<double>(cloud.size()), 0.11) << view.camera.name;
  }
  fs::remove(folder / clip.evidence.depth_views[2].files[static_cast<std::size_t>(frame)]);
  const auto discovery = Discover(Declared(
      "ntu_views", {"ingest.path=" + folder.string(), "ingest.source.views.intrinsics=[-500, 500, 255.5, 211.5]"}));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const mocurate::Ingested without = RunIngest(discovery->items.at(0), "without");
  ASSERT_TRUE(without.outcome) << without.outcome.error().Message();
  EXPECT_EQ(without.clip.evidence.depth_views.size(), 2u);
  EXPECT_THAT(Found(without, "depth_excluded"), ElementsAre(1.0));
  EXPECT_THAT(Found(without, "intrinsics_contradiction"), SizeIs(2));
}

TEST_F(NtuViews, ReduceTheErrorOfASingleSensor) {
  StudioOptions options = Throw();
  options.tracker = KinectTracker();
  options.false_track_share = 1.0;
  options.rig.clock_offset_s = 0.12;
  const std::vector<double> clock_s = FaultsOf(options.rig, RingRig({}, SensorKind::kDepth), options.seed).clock_s;
  Write(options);
  const mocurate::Ingested merged = Run();
  ASSERT_TRUE(merged.outcome) << merged.outcome.error().Message();
  for (int k = 1; k < 3; ++k) {
    const std::string key = "view.C00" + std::to_string(k + 1);
    EXPECT_NEAR(std::stod(merged.clip.provenance.at(key + ".offset_ms")), 1e3 * clock_s[static_cast<std::size_t>(k)],
                16.7);
  }
  for (const auto& [id, clip] : Ingested("ntu", "nturgb+d_skeletons")) {
    if (id.find("C001") != std::string::npos) {
      EXPECT_LT(ErrorOf(merged.clip), 0.8 * ErrorOf(clip));
    }
  }
}

TEST_F(NtuViews, ReportAnAbsentOrEmptyCameraAndUseTheOthers) {
  Write(Throw());
  fs::remove(folder / FileOf(3));
  NtuSkeleton empty = Read(FileOf(2));
  for (auto& bodies : empty.frames) bodies.clear();
  Put(FileOf(2), empty);
  const mocurate::Ingested ingested = Run();
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_THAT(Found(ingested, "camera_missing"), SizeIs(1));
  EXPECT_THAT(Found(ingested, "no_person_in_view"), SizeIs(1));
  EXPECT_EQ(ingested.clip.provenance.at("view.C002"), "excluded");
  EXPECT_EQ(ingested.clip.provenance.count("view.C003"), 0u);
  EXPECT_LT(ErrorOf(ingested.clip), 1e-5) << "only one camera remains";
}

TEST_F(NtuViews, ExcludeAMirroredCameraOfThreeAndReportAmbiguityOfTwo) {
  Write(Throw());
  NtuSkeleton mirrored = Read(FileOf(1));
  for (auto& bodies : mirrored.frames) {
    for (NtuBody& body : bodies) {
      for (NtuJoint& joint : body.joints) joint.x_m = -joint.x_m;
    }
  }
  Put(FileOf(1), mirrored);
  const mocurate::Ingested three = Run();
  ASSERT_TRUE(three.outcome) << three.outcome.error().Message();
  EXPECT_EQ(three.clip.provenance.at("view.reference"), "C002");
  EXPECT_EQ(three.clip.provenance.at("view.C001"), "excluded");
  EXPECT_THAT(Found(three, "view_excluded"), SizeIs(1));
  fs::remove(folder / FileOf(3));
  ExpectError(Run().outcome, ErrorCode::kInconsistent, FileOf(1));
}

TEST_F(NtuViews, ExcludeAViewOfAnotherPerformance) {
  StudioOptions options = Throw();
  options.actions = {"throw", "sit_down"};
  Write(options);
  fs::remove(folder / FileOf(2));
  fs::rename(folder / FileOf(2, "P001R001A008"), folder / FileOf(2));
  for (const int camera : {1, 3}) fs::remove(folder / FileOf(camera, "P001R001A008"));
  const mocurate::Ingested ingested = Run();
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_THAT(Found(ingested, "view_excluded"), SizeIs(1));
  EXPECT_EQ(ingested.clip.provenance.at("view.C002"), "excluded");
  EXPECT_LT(ErrorOf(ingested.clip), 0.01);
}

TEST_F(NtuViews, RefuseACameraThatBeganLateUnlessItIsDeclared) {
  Write(Throw());
  NtuSkeleton late = Read(FileOf(2));
  const auto lost = static_cast<std::ptrdiff_t>(std::min<std::size_t>(40, late.frames.size() / 2));
  ASSERT_GT(lost, 31) << "more than views.max_offset";
  late.frames.erase(late.frames.begin(), late.frames.begin() + lost);
  Put(FileOf(2), late);
  const mocurate::Ingested apart = Run();
  ASSERT_FALSE(apart.outcome);
  EXPECT_EQ(FaultCode(apart.outcome.error(), "ntu_skeleton"), "view_numbering");
  EXPECT_NEAR(apart.outcome.error().number, static_cast<double>(lost), 1.0);
  const auto discovery =
      Discover(Declared("ntu_views", {"ingest.path=" + folder.string(),
                                      "ingest.source.first_frame={C002: " + std::to_string(1 - lost) + "}"}));
  ASSERT_TRUE(discovery) << discovery.error().Message();
  const mocurate::Ingested declared = RunIngest(discovery->items.at(0), "views");
  ASSERT_TRUE(declared.outcome) << declared.outcome.error().Message();
  EXPECT_EQ(declared.clip.provenance.at("view.C002"), "used");
  EXPECT_NEAR(std::stod(declared.clip.provenance.at("view.C002.offset_ms")), 1e3 * static_cast<double>(lost) / 30.0,
              5.0);
  EXPECT_THAT(Found(declared, "clock_offset"), IsEmpty()) << "nothing beside what is declared";
  EXPECT_LT(ErrorOf(declared.clip), 0.01);
}

TEST_F(NtuViews, MatchTwoPeopleAcrossCameras) {
  StudioOptions options = Throw();
  options.subjects = 2;
  options.actions = {"throw", "kick_something"};
  const std::vector<RigidTransform> places = TrueExtrinsics(options);
  Write(options);
  for (int camera = 1; camera <= 3; ++camera) {
    NtuSkeleton both = Read(FileOf(camera)), other = Read(FileOf(camera, "P002R001A024"));
    const std::size_t frames = std::min(both.frames.size(), other.frames.size());
    both.frames.resize(frames);
    // 1.2 m to the side in the world of camera 1.
    const Matrix3d camera_from_first =
        places[static_cast<std::size_t>(camera - 1)].rotation.toRotationMatrix().transpose();
    const Vector3d aside = kCanonicalFromSensor.rotation.conjugate() * (camera_from_first * Vector3d(1.2, 0.0, 0.0));
    for (std::size_t f = 0; f < frames; ++f) {
      NtuBody body = other.frames[f].at(0);
      for (NtuJoint& joint : body.joints) joint.x_m += aside.x(), joint.y_m += aside.y(), joint.z_m += aside.z();
      // The second sensor lists the people in reverse order.
      both.frames[f].insert(camera == 2 ? both.frames[f].begin() : both.frames[f].end(), body);
    }
    for (const char* rest : {"P001R001A007", "P002R001A007", "P001R001A024", "P002R001A024"})
      fs::remove(folder / FileOf(camera, rest));
    Put(FileOf(camera, "P001R001A050"), both);
  }
  const mocurate::Ingested first = Run(0), second = Run(1);
  ASSERT_TRUE(first.outcome) << first.outcome.error().Message();
  ASSERT_TRUE(second.outcome) << second.outcome.error().Message();
  EXPECT_THAT(first.clip.id(), StartsWith("ntu_views/P001a/S001P001R001A050"));
  EXPECT_THAT(Found(first, "view_excluded"), IsEmpty());
  EXPECT_LT(std::min(ErrorOf(first.clip), ErrorOf(second.clip)), 0.01);
  EXPECT_GT(std::max(ErrorOf(first.clip), ErrorOf(second.clip)), 0.5);
}

TEST_F(NtuViews, ReadARecordedFileWithItsIntrinsics) {
  if (TestData().empty()) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const std::string name = "S001C003P008R002A058.skeleton";
  const auto bytes = ReadFile(TestData() + "/ntu/" + name);
  ASSERT_TRUE(bytes);
  NtuSkeleton real = *ParseNtuSkeleton(*bytes, name);
  mocurate::Put(folder / "nturgb+d_skeletons" / name, *bytes);
  // A second sensor, 46 degrees to the left, starts three frames later, with its own noise.
  Random random(3, "views", "real");
  const RigidTransform moved{ExpQuaternion(Vector3d(0.02, 0.8, 0.01)), Vector3d(2.2, 0.05, 0.9)};
  real.frames.erase(real.frames.begin(), real.frames.begin() + 3);
  for (auto& people : real.frames) {
    for (NtuBody& body : people) {
      for (NtuJoint& joint : body.joints) {
        const Vector3d place = moved * Vector3d(joint.x_m, joint.y_m, joint.z_m) +
                               0.01 * Vector3d(random.Normal(), random.Normal(), random.Normal());
        joint.x_m = place.x(), joint.y_m = place.y(), joint.z_m = place.z();
      }
    }
  }
  mocurate::Put(folder / "nturgb+d_skeletons/S001C001P008R002A058.skeleton", WriteNtuSkeleton(real));
  const mocurate::Ingested ingested = Run();
  ASSERT_TRUE(ingested.outcome) << ingested.outcome.error().Message();
  EXPECT_EQ(ingested.clip.provenance.at("view.reference"), "C001");
  EXPECT_NEAR(std::stod(ingested.clip.provenance.at("view.C003.offset_ms")), -100.0, 5.0);
  EXPECT_LT(std::stod(ingested.clip.provenance.at("view.C003.disagreement_mm")), 25.0);
  EXPECT_THAT(Found(ingested, "camera_missing"), SizeIs(1));
}

}  // namespace
}  // namespace mocurate
