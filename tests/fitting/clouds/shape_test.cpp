// Size and body shape of a person from clouds in approximately known poses.
#include "fitting/clouds/cloud_shape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/QR>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/sha256.h"
#include "core/body/capsule_body.h"
#include "core/body/skinned_body.h"
#include "core/store/body_file.h"
#include "core/store/store.h"
#include "fitting/clouds/cloud_uncertainty.h"
#include "fitting/proportions.h"
#include "fitting/stages.h"
#include "tests/fitting/cloud_scene.h"
#include "tests/support/scratch_folder.h"

namespace mocurate {
namespace {

constexpr double kScale = 1.06;
const BodyShape kShape = {0.9, -0.8, 0.7, -0.6, 0.5};

/// Points on the surface of a posed body, about two centimetres apart; none inside another capsule.
FusedCloud SurfaceOf(const CapsuleBody& body, const PoseState& state) {
  std::vector<Vector3d> points, normals;
  std::vector<CapsuleEnds> ends;
  for (const BodyCapsule& capsule : body.capsules) ends.push_back(EndsOf(capsule, state, 0));
  for (std::size_t c = 0; c < body.capsules.size(); ++c) {
    const double radius = body.capsules[c].radius;
    const Vector3d axis = ends[c].end - ends[c].begin;
    const Vector3d along = axis.norm() > 0.0 ? Vector3d(axis.normalized()) : Vector3d(Vector3d::UnitY());
    const Vector3d across = along.unitOrthogonal();
    const Vector3d third = along.cross(across);
    const int around = std::max(6, static_cast<int>(2.0 * M_PI * radius / 0.02));
    const int steps = std::max(1, static_cast<int>(axis.norm() / 0.02));
    const auto add = [&](const Vector3d& centre, const Vector3d& normal) {
      const Vector3d point = centre + radius * normal;
      for (std::size_t k = 0; k < body.capsules.size(); ++k) {
        if (k != c && SignedDistance(ends[k].begin, ends[k].end, body.capsules[k].radius, point) < 1e-4) return;
      }
      points.push_back(point);
      normals.push_back(normal);
    };
    for (int i = 0; i < around; ++i) {
      const double angle = 2.0 * M_PI * i / around;
      const Vector3d normal = std::cos(angle) * across + std::sin(angle) * third;
      for (int k = 0; k <= steps; ++k) add(ends[c].begin + axis * k / steps, normal);
      for (const double tilt : {0.4, 0.8, 1.2}) {
        add(ends[c].end, std::cos(tilt) * normal + std::sin(tilt) * along);
        add(ends[c].begin, std::cos(tilt) * normal - std::sin(tilt) * along);
      }
    }
  }
  FusedCloud cloud;
  cloud.points.resize(3, static_cast<Eigen::Index>(points.size()));
  cloud.normals.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    cloud.points.col(static_cast<Eigen::Index>(i)) = points[i];
    cloud.normals.col(static_cast<Eigen::Index>(i)) = normals[i];
  }
  return cloud;
}

std::vector<double> LengthsAt(double scale, const Skeleton& skeleton) {
  std::vector<double> lengths = skeleton.RestBoneLengths();
  for (double& length : lengths) length *= scale;
  return lengths;
}

TEST(FitShape, RecoversSizeAndShapeInApproximatelyKnownPoses) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  const SkeletonPtr own = WithShape(skeleton, kShape);
  const CapsuleBody body = CapsuleBody::Make(own, kScale);
  std::vector<FusedCloud> clouds;
  ShapedPerson start;
  start.scale = 0.97 * kScale;
  for (const double bend : {0.2, 0.7, 1.2}) {
    PoseState state(*own, 1, LengthsAt(kScale, *own), body.MovingJoints());
    const auto turn = [&](const char* joint, const Vector3d& by) {
      Eigen::Map<Vector3d>(state.rotation(0, *own->FindJoint(joint))) = by;
    };
    turn("left_shoulder", {0.0, 0.0, -1.0});
    turn("right_shoulder", {0.0, 0.2, 0.9});
    turn("left_elbow", {0.0, -bend, 0.0});
    turn("right_elbow", {0.0, 0.5 * bend, 0.0});
    turn("left_hip", {-bend, 0.0, 0.1});
    turn("left_knee", {bend, 0.0, 0.0});
    state.Update(0, 1, false);
    clouds.push_back(SurfaceOf(body, state));
    turn("left_elbow", {0.0, -bend + 0.1, 0.0});
    state.translation(0)[1] += 0.015;
    start.poses.push_back(state.FrameParameters(0));
  }
  const auto found = FitShape(clouds, skeleton, start, PointCloudOptions());
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_NEAR(found->scale, kScale, 0.01);
  for (int k = 0; k < kShapeComponents; ++k) EXPECT_NEAR(found->shape[k], kShape[k], 0.35) << "component " << k;
}

TEST(FitShape, KeepsTheShapeWithoutEvidence) {
  FusedCloud few;
  few.points = Eigen::Matrix3Xd::Constant(3, 3, 5.0);
  few.normals = Eigen::Matrix3Xd::Constant(3, 3, 0.5);
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  ShapedPerson start;
  start.scale = 0.9;
  start.poses = {std::vector<double>(3 + 3 * skeleton->joints.size(), 0.0)};
  const auto found = FitShape({few}, skeleton, start, PointCloudOptions());
  ASSERT_TRUE(found) << found.error().Message();
  EXPECT_NEAR(found->scale, 0.9, 1e-9);
  for (const double component : found->shape) EXPECT_NEAR(component, 0.0, 1e-9);
}

TEST(WithShape, KeepsTheSizeAndSkeletonsWithoutATemplate) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  const SkeletonPtr own = WithShape(skeleton, kShape);
  EXPECT_NEAR(BodyScale(*skeleton, own->RestBoneLengths()), 1.0, 0.01);
  EXPECT_EQ(own->shape, kShape);
  const int left = *own->FindJoint("left_elbow"), right = *own->FindJoint("right_elbow");
  EXPECT_DOUBLE_EQ(own->joints[left].rest_offset.x(), -own->joints[right].rest_offset.x());
  const SkeletonPtr plain = PlainSkeleton();
  EXPECT_EQ(WithShape(plain, kShape), plain);
}

/// Bones of the man and the woman from whom the components were computed.
TEST(BodyShape, ExplainsBonesOfManAndWoman) {
  const char* data = std::getenv("MOCURATE_DATA");
  if (data == nullptr) GTEST_SKIP() << "MOCURATE_DATA is not set";
  const auto body = ReadBodyTemplate(std::filesystem::path(data) / "body_cc0" / "body_cc0.h5");
  ASSERT_TRUE(body) << body.error().Message();
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  for (const double sex : {-1.0, 1.0}) {
    const RestBody rest = Shaped(*body, {sex});
    Eigen::MatrixXd rows(3 * 23, 1 + kShapeComponents);
    Eigen::VectorXd wanted(rows.rows());
    for (int j = 1; j < 24; ++j) {
      wanted.segment<3>(3 * j - 3) = rest.joints[j] - rest.joints[body->parents[j]];
      rows.block<3, 1>(3 * j - 3, 0) = skeleton->joints[j].rest_offset;
      for (int k = 0; k < kShapeComponents; ++k) {
        BodyShape one{};
        one[k] = 1.0;
        rows.block<3, 1>(3 * j - 3, 1 + k) = OffsetChange(skeleton->joints[j].name, one);
      }
    }
    const Eigen::VectorXd best = rows.colPivHouseholderQr().solve(wanted);
    EXPECT_LT((rows * best - wanted).norm() / std::sqrt(23.0), 0.002) << "metres per bone, RMS";
    EXPECT_GT((rows.col(0) - wanted).norm() / std::sqrt(23.0), 0.01) << "without components";
    EXPECT_LT(best.tail<kShapeComponents>().cwiseAbs().maxCoeff(), 4.0) << "deviations";
  }
}

/// Tracks of a person who stands still, and three depth views rendered from the same joints.
class BodyOfBoth : public ::testing::Test {
 protected:
  void SetUp() override {
    const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
    const Motion still = StandingStill(skeleton, 1.0, FrameRate{12, 1}, 4);
    Expected<Clip> clip = RenderClip(still, folder_ / "depth");
    ASSERT_TRUE(clip) << clip.error().Message();
    clip_ = *std::move(clip);
    clip_.identity.source = "studio";
    clip_.identity.person = "p1";
    clip_.identity.recording = "r1";
    clip_.identity.end_frame = 4;
    for (DepthView& view : clip_.evidence.depth_views) {
      for (const auto& file : view.files) view.sha256.push_back(*Sha256OfFile(file));
    }
    JointTracks tracks;
    for (const Joint& joint : skeleton->joints) tracks.names.push_back(joint.name);
    tracks.time_s = clip_.evidence.depth_views[0].time_s;
    tracks.positions = still.joints;
    tracks.confidence.assign(4 * skeleton->joints.size(), 1.0);
    clip_.evidence.tracks = tracks;
  }
  Expected<StageOutcome> Measure() const {
    StageRequest request;
    request.stage = "proportions";
    request.item = "p1";
    request.options = {{"skeleton", "smpl24"}, {"method", "joints_and_clouds"}};
    EXPECT_TRUE(WriteEvidence(clip_, folder_ / "r1.h5"));
    request.inputs.push_back({"evidence", clip_.id(), folder_ / "r1.h5", std::string(64, 'a')});
    request.output = folder_ / "proportions.out";
    return ProportionsStage(request);
  }

  ScratchFolder folder_;
  Clip clip_;
};

TEST_F(BodyOfBoth, HasBodyShapeAndASizeNearTheTracks) {
  const auto measured = Measure();
  ASSERT_TRUE(measured) << measured.error().Message();
  EXPECT_TRUE(measured->findings.empty()) << measured->findings.front().message;
  EXPECT_EQ(measured->summary["body_shape"].size(), static_cast<std::size_t>(kShapeComponents));
  EXPECT_NEAR(measured->summary["scale"].get<double>(), 1.0, 0.09) << "rendered slightly stout";
}

TEST_F(BodyOfBoth, UsesTheTracksWhereDepthHasAnotherSize) {
  const Vector3d root = clip_.evidence.tracks->positions.at(0, 0);
  JointPositions& positions = clip_.evidence.tracks->positions;
  for (int f = 0; f < positions.frames; ++f) {
    for (int j = 0; j < positions.joints; ++j) positions.at(f, j) = root + 1.3 * (positions.at(f, j) - root);
  }
  const auto measured = Measure();
  ASSERT_TRUE(measured) << measured.error().Message();
  ASSERT_EQ(measured->findings.size(), 1u) << measured->summary.dump();
  EXPECT_EQ(measured->findings[0].code, "modalities_differ_in_size");
  EXPECT_NEAR(measured->summary["scale"].get<double>(), 1.3, 0.01);
  EXPECT_TRUE(measured->summary["body_shape"].empty());
}

TEST_F(BodyOfBoth, UsesTheTracksWhereDepthShowsNoPerson) {
  for (DepthView& view : clip_.evidence.depth_views) view.camera.camera_from_world.translation *= 1000.0;
  const auto measured = Measure();
  ASSERT_TRUE(measured) << measured.error().Message();
  ASSERT_EQ(measured->findings.size(), 1u);
  EXPECT_EQ(measured->findings[0].code, "no_proportions_from_clip");
  EXPECT_NEAR(measured->summary["scale"].get<double>(), 1.0, 0.01);
}

TEST(BodyShape, RoundTripsThroughTheArtifactAndRefusesMalformedValues) {
  const SkeletonPtr skeleton = *LoadSkeleton("smpl24");
  Proportions person = EstimateProportions({}, skeleton, {});
  nlohmann::json json = ProportionsJson(person, *skeleton);
  EXPECT_TRUE(json["body_shape"].empty());
  EXPECT_EQ(BodyFromJson(json, skeleton, "p1")->skeleton, skeleton);
  person.skeleton = WithShape(skeleton, kShape);
  json = ProportionsJson(person, *skeleton);
  const auto read = BodyFromJson(json, skeleton, "p1");
  ASSERT_TRUE(read) << read.error().Message();
  for (int k = 0; k < kShapeComponents; ++k) EXPECT_NEAR(read->skeleton->shape[k], kShape[k], 1e-12);
  for (const char* malformed : {"[1, 2]", "\"stout\"", "[1, 2, 3, 4, \"5\"]", "[1, 2, 3, 4, 1e9]", "{}"}) {
    json["body_shape"] = nlohmann::json::parse(malformed);
    const auto refused = BodyFromJson(json, skeleton, "p1");
    ASSERT_FALSE(refused) << malformed;
    EXPECT_EQ(refused.error().code, ErrorCode::kMalformed);
    EXPECT_THAT(refused.error().Message(), ::testing::HasSubstr("'body_shape'"));
  }
}

}  // namespace
}  // namespace mocurate
