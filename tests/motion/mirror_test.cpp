#include "core/motion/operations.h"
#include "tests/motion/builders.h"

namespace mocurate {
namespace {

using test::Built;
using test::FullClip;
using test::LargestAngle;
using test::LargestDistance;

const char* const kAllMirrored[] = {"smpl24", "humanact12", "ntu25",    "ntu18",    "ntu14", "cmu20",
                                    "cmu31",  "kinect20",   "openni15", "openni16", "a2m21", "bandai22"};

TEST(Mirror, TwiceIsTheIdentity) {
  for (const char* name : kAllMirrored) {
    const Clip clip = FullClip(name, 5);
    const Clip twice = Mirror(Mirror(clip));
    EXPECT_LT(LargestDistance(clip.motion->joints, twice.motion->joints), 1e-12) << name;
    EXPECT_LT(LargestAngle(*clip.motion, *twice.motion), 1e-7) << name;
    EXPECT_EQ(clip.motion->state, twice.motion->state);
    EXPECT_EQ(clip.motion->contact, twice.motion->contact);
    EXPECT_EQ(clip.motion->position_cov, twice.motion->position_cov);
    EXPECT_EQ(clip.motion->bone_length, twice.motion->bone_length);
    EXPECT_EQ(clip.motion->rotation_sigma, twice.motion->rotation_sigma);
    EXPECT_EQ(clip.evidence.tracks->names, twice.evidence.tracks->names);
    EXPECT_EQ(clip.evidence.tracks->positions.xyz, twice.evidence.tracks->positions.xyz);
  }
}

TEST(Mirror, JointsAreThoseOfTheOtherSideReflected) {
  for (const char* name : kAllMirrored) {
    const Clip clip = FullClip(name, 5);
    const Clip mirrored = Mirror(clip);
    ASSERT_TRUE(mirrored.motion->Check()) << name << mirrored.motion->Check().error().Message();
    // Bandai's own offsets are symmetric to micrometres only.
    const double tolerance = std::string(name) == "bandai22" ? 2e-5 : 1e-12;
    for (int f = 0; f < 5; ++f) {
      for (int j = 0; j < clip.motion->joint_count(); ++j) {
        const Vector3d expected = clip.motion->joints.at(f, j).cwiseProduct(Vector3d(-1, 1, 1));
        const int partner = clip.motion->skeleton->joints[j].mirror;
        EXPECT_LT((mirrored.motion->joints.at(f, partner) - expected).norm(), tolerance)
            << name << " " << clip.motion->skeleton->joints[j].name;
      }
    }
  }
}

TEST(Mirror, CarriesStateContactAndCovarianceAlong) {
  const Clip clip = FullClip("smpl24", 2);
  const Clip mirrored = Mirror(clip);
  EXPECT_EQ(mirrored.motion->state[24 + 4], clip.motion->state[24 + 5]) << "left knee and right knee";
  EXPECT_EQ(mirrored.motion->contact[0], clip.motion->contact[1]);
  EXPECT_EQ(mirrored.motion->bone_length[4], clip.motion->bone_length[5]);
  const float* a = clip.motion->position_cov.data() + 6 * 5;
  const float* b = mirrored.motion->position_cov.data() + 6 * 4;
  EXPECT_FLOAT_EQ(b[0], a[0]);
  EXPECT_FLOAT_EQ(b[1], -a[1]);
  EXPECT_FLOAT_EQ(b[2], -a[2]);
  EXPECT_FLOAT_EQ(b[4], a[4]);
}

TEST(Mirror, TracksSwapTheirSidesWhateverTheyAreCalled) {
  Clip clip;
  JointTracks tracks;
  tracks.names = {"HEAD", "LEFT_HAND", "RIGHT_HAND", "LHip", "RHip", "Hand_L", "Hand_R", "Torso"};
  tracks.time_s = {0.0};
  tracks.positions = JointPositions(1, 8);
  tracks.positions.at(0, 1) = Vector3d(0.3, 1, 2);
  tracks.confidence.assign(8, 1.0);
  clip.evidence.tracks = tracks;
  const Clip mirrored = Mirror(clip);
  const std::vector<std::string> expected = {"HEAD", "RIGHT_HAND", "LEFT_HAND", "RHip",
                                             "LHip", "Hand_R",     "Hand_L",    "Torso"};
  EXPECT_EQ(mirrored.evidence.tracks->names, expected);
  EXPECT_EQ(Vector3d(mirrored.evidence.tracks->positions.at(0, 1)), Vector3d(-0.3, 1, 2));
}

TEST(Mirror, TheReflectedCameraSeesTheReflectedPointInTheSamePixel) {
  const Clip clip = FullClip("smpl24", 2);
  const Clip mirrored = Mirror(clip);
  const Vector3d point(0.4, 1.1, 0.3);
  const Vector2d pixel = clip.evidence.depth_views[0].camera.ProjectWorld(point).value();
  const Camera& camera = mirrored.evidence.depth_views[0].camera;
  EXPECT_LT((camera.ProjectWorld(Vector3d(-0.4, 1.1, 0.3)).value() - pixel).norm(), 1e-9);
  const KeypointView& seen = mirrored.evidence.keypoint_views[0];
  EXPECT_LT((seen.camera.ProjectWorld(Vector3d(-0.4, 1.1, 0.3)).value() - pixel).norm(), 1e-9);
  EXPECT_EQ(seen.values, clip.evidence.keypoint_views[0].values);
  EXPECT_EQ(mirrored.evidence.keypoint_names, (std::vector<std::string>{"nose", "right_knee", "left_knee"}));
}

TEST(Mirror, PointsOfACloudAreReflected) {
  const Clip clip = FullClip("smpl24", 2);
  const Vector3d in_file(300, -200, 100);
  const auto placed = [&](const Clip& of) {
    const CloudFiles& clouds = *of.evidence.clouds;
    return Vector3d(clouds.world_from_file * Vector3d(clouds.metres_per_unit * in_file));
  };
  const Vector3d there = placed(clip);
  EXPECT_LT((placed(Mirror(clip)) - Vector3d(-there.x(), there.y(), there.z())).norm(), 1e-12);
  EXPECT_LT((placed(Mirror(Mirror(clip))) - there).norm(), 1e-12);
}

TEST(Mirror, AStandingPersonKeepsHerPoseInBandaisTwistedFrames) {
  // Mirroring must not turn frames about their bones: the mirrored identity pose has the identity's rotations, up to
  // the declared reflections, which cancel for every joint whose reflection equals its parent's.
  const SkeletonPtr skeleton = Built("bandai22");
  const int count = skeleton->joint_count();
  Clip clip;
  clip.motion = MakeMotion(skeleton, {30, 1}, {Vector3d::Zero()},
                           std::vector<Quaterniond>(static_cast<std::size_t>(count), Quaterniond::Identity()), {});
  const Clip mirrored = Mirror(clip);
  const int arm = *skeleton->FindJoint("LowerArm_L");
  EXPECT_LT(AngleBetween(mirrored.motion->rotation_at(0, arm), Quaterniond::Identity()), 1e-4);
}

}  // namespace
}  // namespace mocurate
