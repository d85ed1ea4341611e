#include "fitting/proportions.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "fitting/solver/bone_lengths.h"
#include "tests/fitting/takes.h"

namespace mocurate {
namespace {

/// A take of a person 8 % larger than the rest skeleton.
PlayedTake LargerPerson(int frames) {
  PlayedTake take = SmoothTake(frames);
  std::vector<double> bones = take.truth.bone_length;
  for (double& bone : bones) bone *= 1.08;
  take.truth =
      MakeMotion(take.truth.skeleton, take.truth.rate, take.truth.root_translation, take.truth.rotation, bones);
  take.tracks.positions = take.truth.joints;
  return take;
}

TEST(Proportions, AreExactWithoutNoise) {
  const PlayedTake take = LargerPerson(50);
  const auto person = EstimateProportions({take.tracks}, take.tracks.skeleton, ProportionsOptions{});
  EXPECT_NEAR(person.scale, 1.08, 1e-5);
  for (int j = 1; j < take.tracks.joints(); ++j) EXPECT_NEAR(person.bone_length[j], take.truth.bone_length[j], 2e-4);
}

TEST(Proportions, StatureIsThatOfAPersonWhereTheRestPoseDoesNotStand) {
  const SkeletonPtr lying = *LoadSkeleton("bandai22"), standing = *LoadSkeleton("smpl24");
  EXPECT_NEAR(Stature(*lying, lying->RestBoneLengths()), 1.47, 0.1);  // every bone along x or y of its parent
  Skeleton along_x = *standing;
  for (Joint& joint : along_x.joints) joint.rest_offset = Vector3d(joint.rest_offset.norm(), 0.0, 0.0);
  EXPECT_NEAR(Stature(along_x, along_x.RestBoneLengths()), 1.69, 0.05) << "to the toes, not to the hands";
  double low = 0.0, high = 0.0;
  const JointPositions rest = MakeMotion(standing, FrameRate{}, {Vector3d::Zero()},
                                         std::vector<Quaterniond>(standing->joints.size(), Quaterniond::Identity()), {})
                                  .joints;
  for (int j = 0; j < rest.joints; ++j) {
    low = std::min(low, rest.at(0, j).y());
    high = std::max(high, rest.at(0, j).y());
  }
  EXPECT_EQ(Stature(*standing, standing->RestBoneLengths()), high - low);
}

TEST(Proportions, AreNotInflatedByNoise) {
  PlayedTake take = LargerPerson(400);
  AddNoise(take.tracks, 0.02, 3);
  const BoneEstimate bones = EstimateBoneLengths({take.tracks}, *take.tracks.skeleton, true);
  for (int j = 1; j < take.tracks.joints(); ++j) {
    EXPECT_NEAR(bones.length[j], take.truth.bone_length[j], 0.006) << take.tracks.skeleton->joints[j].name;
  }
}

/// Noise five times as large towards a camera lengthens short bones by a tenth, and affects most samples less.
TEST(Proportions, AreNotInflatedByNoiseInDepth) {
  PlayedTake take = LargerPerson(3000);
  Random random(5, "depth");
  const Vector3d sigma(0.01, 0.01, 0.05);
  for (int f = 0; f < take.tracks.frames(); ++f) {
    for (int j = 0; j < take.tracks.joints(); ++j) {
      take.tracks.positions.at(f, j) += sigma.cwiseProduct(Vector3d(random.Normal(), random.Normal(), random.Normal()));
      take.tracks.precision.emplace_back(Vector3d(1.0, 1.0, 1.0 / 25.0).asDiagonal());
    }
  }
  const BoneEstimate bones = EstimateBoneLengths({take.tracks}, *take.tracks.skeleton, true);
  for (const int j : {1, 2, 4, 5, 10, 13}) {
    EXPECT_NEAR(bones.length[j], take.truth.bone_length[j], 0.003) << take.tracks.skeleton->joints[j].name;
  }
}

/// Where the root of the neck is not tracked, hips and head determine the trunk's length. Without that rule it would
/// fold or pull them apart.
TEST(Proportions, SpanATrunkWhoseMiddleIsUnobserved) {
  PlayedTake take = SmoothTake(200);
  const Skeleton& skeleton = *take.tracks.skeleton;
  const int chest = *skeleton.FindJoint("chest");
  const int head = *skeleton.FindJoint("head");
  std::vector<double> bones = take.truth.bone_length;
  bones[chest] *= 0.7;
  std::vector<Quaterniond> upright = take.truth.rotation;
  for (int f = 0; f < 200; ++f) upright[static_cast<std::size_t>(f * take.tracks.joints() + chest)].setIdentity();
  take.truth = MakeMotion(take.truth.skeleton, take.truth.rate, take.truth.root_translation, upright, bones);
  take.tracks.positions = take.truth.joints;
  for (int f = 0; f < 200; ++f) Hide(take.tracks, f, chest);
  const auto person = EstimateProportions({take.tracks}, take.tracks.skeleton, ProportionsOptions{});
  EXPECT_NEAR(person.bone_length[chest] + person.bone_length[head], bones[chest] + bones[head], 0.045)
      << "the rest pose is 0.12 m longer";
  EXPECT_NEAR(person.bone_length[5], bones[5], 2e-4) << "observed bones keep their length";
}

/// Arms that always hang are as rigid as a trunk but not part of it. Unobserved shoulders lie where the person's size
/// puts them, not on the line from neck to elbows.
TEST(Proportions, DoNotInferUnobservedShouldersFromHangingArms) {
  const SkeletonPtr smpl24 = *LoadSkeleton("smpl24");
  std::vector<Quaterniond> rotation;
  for (int f = 0; f < 60; ++f) {
    for (const Joint& joint : smpl24->joints) {
      const double down = joint.name == "left_shoulder" ? -1.3 : joint.name == "right_shoulder" ? 1.3 : 0.0;
      rotation.push_back(ExpQuaternion(Vector3d(0.0, 0.0, down)));
    }
  }
  PlayedTake take;
  take.tracks.skeleton = smpl24;
  for (int f = 0; f < 60; ++f) take.tracks.time_s.push_back(f / 30.0);
  take.truth = MakeMotion(smpl24, FrameRate{30, 1}, std::vector<Vector3d>(60, Vector3d(0.0, 0.9, 0.0)), rotation,
                          smpl24->RestBoneLengths());
  take.tracks.positions = take.truth.joints;
  take.tracks.confidence.assign(take.truth.joints.xyz.size() / 3, 1.0);
  for (const char* joint : {"left_collar", "right_collar", "left_shoulder", "right_shoulder"}) {
    for (int f = 0; f < 60; ++f) Hide(take.tracks, f, *smpl24->FindJoint(joint));
  }
  const auto person = EstimateProportions({take.tracks}, smpl24, ProportionsOptions{});
  for (const char* joint : {"left_collar", "right_shoulder", "left_elbow", "right_elbow"}) {
    const int j = *smpl24->FindJoint(joint);
    EXPECT_NEAR(person.bone_length[j], take.truth.bone_length[j], 0.003) << joint;
    EXPECT_EQ(person.skeleton->joints[j].rest_offset, smpl24->joints[j].rest_offset) << joint;
  }
}

TEST(Proportions, ScaleUnobservedBonesWithTheRest) {
  PlayedTake take = LargerPerson(50);
  for (int f = 0; f < 50; ++f) {
    Hide(take.tracks, f, 0);   // root: from the distances between chest and hips
    Hide(take.tracks, f, 13);  // a leaf: rest length times scale
  }
  const auto person = EstimateProportions({take.tracks}, take.tracks.skeleton, ProportionsOptions{});
  EXPECT_NEAR(person.bone_length[1], take.truth.bone_length[1], 0.02);
  EXPECT_NEAR(person.bone_length[9], take.truth.bone_length[9], 0.01);
  EXPECT_NEAR(person.bone_length[13], 0.12 * 1.08, 2e-4);
  EXPECT_EQ(person.samples[13], 0);
}

TEST(Proportions, AreSymmetricByDefault) {
  PlayedTake take = LargerPerson(60);
  AddNoise(take.tracks, 0.01, 8);
  ProportionsOptions options;
  const auto both = EstimateProportions({take.tracks}, take.tracks.skeleton, options);
  EXPECT_EQ(both.bone_length[5], both.bone_length[8]);
  options.symmetric = false;
  const auto each = EstimateProportions({take.tracks}, take.tracks.skeleton, options);
  EXPECT_NE(each.bone_length[5], each.bone_length[8]);
}

/// Hips that hang from the pelvis, before or behind it, instead of pointing sideways; and a leaning spine.
SkeletonPtr OtherBody(const Skeleton& skeleton, double forward) {
  auto other = std::make_shared<Skeleton>(skeleton);
  for (Joint& joint : other->joints) {
    const double length = joint.rest_offset.norm();
    if (joint.parent != 0) continue;
    Vector3d direction = joint.rest_offset.normalized();
    direction += joint.mirror == static_cast<int>(&joint - other->joints.data()) ? Vector3d(0, 0, 0.2)
                                                                                 : Vector3d(0, -0.8, forward);
    joint.rest_offset = length * direction.normalized();
  }
  return other;
}

/// Signed volume of three bones: its sign distinguishes the two mirror images.
double Volume(const Skeleton& skeleton, const std::vector<int>& star) {
  const Vector3d across = skeleton.joints[star[0]].rest_offset.cross(skeleton.joints[star[1]].rest_offset);
  return across.dot(skeleton.joints[star[2]].rest_offset);
}

double AngleBetweenJoints(const Skeleton& skeleton, int a, int b) {
  const Vector3d& u = skeleton.joints[a].rest_offset;
  const Vector3d& v = skeleton.joints[b].rest_offset;
  return std::atan2(u.cross(v).norm(), u.dot(v)) * 180.0 / 3.14159265358979;
}

class PersonsBones : public ::testing::TestWithParam<double> {};

TEST_P(PersonsBones, HaveTheirTrueDirections) {
  PlayedTake take = SmoothTake(400);
  const SkeletonPtr nominal = take.tracks.skeleton;
  const SkeletonPtr body = OtherBody(*nominal, GetParam());
  take.truth = MakeMotion(body, take.truth.rate, take.truth.root_translation, take.truth.rotation, {});
  take.tracks.positions = take.truth.joints;
  std::vector<int> star;
  for (int j = 1; j < nominal->joint_count(); ++j) {
    if (nominal->joints[j].parent == 0) star.push_back(j);
  }
  ASSERT_EQ(star.size(), 3u);
  for (const double noise : {0.0, 0.015}) {
    AddNoise(take.tracks, noise, 7);
    const auto person = EstimateProportions({take.tracks}, nominal, ProportionsOptions{});
    ProportionsOptions given;
    given.own_directions = false;
    const auto kept = EstimateProportions({take.tracks}, nominal, given);
    EXPECT_EQ(kept.skeleton, nominal);
    if (noise == 0.0) {
      EXPECT_GT(Volume(*person.skeleton, star) * Volume(*body, star), 0.0);
    }
    for (std::size_t i = 0; i < star.size(); ++i) {
      for (std::size_t k = i + 1; k < star.size(); ++k) {
        const double truth = AngleBetweenJoints(*body, star[i], star[k]);
        EXPECT_NEAR(AngleBetweenJoints(*person.skeleton, star[i], star[k]), truth, noise == 0.0 ? 1.0 : 4.0)
            << noise << ": the rest-pose prior biases by up to 0.8 degrees";
        EXPECT_GT(std::abs(AngleBetweenJoints(*nominal, star[i], star[k]) - truth), 10.0)
            << "the truth must differ from the nominal skeleton";
      }
      EXPECT_NEAR(person.skeleton->joints[star[i]].rest_offset.norm(), nominal->joints[star[i]].rest_offset.norm(),
                  1e-9);
    }
  }
}

/// A trunk whose every sample has low confidence still has a determined direction.
TEST_P(PersonsBones, AreNotMirroredAtLowConfidence) {
  PlayedTake take = SmoothTake(60);
  const SkeletonPtr nominal = take.tracks.skeleton;
  const SkeletonPtr body = OtherBody(*nominal, GetParam());
  take.tracks.positions =
      MakeMotion(body, take.truth.rate, take.truth.root_translation, take.truth.rotation, {}).joints;
  std::fill(take.tracks.confidence.begin(), take.tracks.confidence.end(), 0.1);
  AddNoise(take.tracks, 0.005, 7);
  std::vector<int> star;
  for (int j = 1; j < nominal->joint_count(); ++j) {
    if (nominal->joints[j].parent == 0) star.push_back(j);
  }
  const auto person = EstimateProportions({take.tracks}, nominal, ProportionsOptions{});
  EXPECT_GT(Volume(*person.skeleton, star) * Volume(*body, star), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Proportions, PersonsBones, ::testing::Values(-0.5, 0.5));

TEST(Proportions, KeepTheSkeletonsDirectionsWhereTheyAreTrue) {
  PlayedTake take = LargerPerson(400);
  AddNoise(take.tracks, 0.015, 3);
  const auto person = EstimateProportions({take.tracks}, take.tracks.skeleton, ProportionsOptions{});
  for (int j = 1; j < take.tracks.joints(); ++j) {
    const Vector3d& own = person.skeleton->joints[j].rest_offset;
    const Vector3d& rest = take.tracks.skeleton->joints[j].rest_offset;
    EXPECT_LT(std::atan2(own.cross(rest).norm(), own.dot(rest)) * 57.3, 4.0) << take.tracks.skeleton->joints[j].name;
  }
}

/// One noisy frame carries little information; an unobserved joint carries none.
TEST(Proportions, KeepTheSkeletonsDirectionsWithoutSamples) {
  PlayedTake one = LargerPerson(1);
  AddNoise(one.tracks, 0.02, 5);
  PlayedTake unobserved = LargerPerson(300);
  const int chest = *unobserved.tracks.skeleton->FindJoint("chest");
  for (int f = 0; f < 300; ++f) Hide(unobserved.tracks, f, chest);
  AddNoise(unobserved.tracks, 0.005, 6);
  for (const SkeletonTracks& tracks : {one.tracks, unobserved.tracks}) {
    const auto person = EstimateProportions({tracks}, tracks.skeleton, ProportionsOptions{});
    for (int j = 1; j < tracks.joints(); ++j) {
      const Vector3d& own = person.skeleton->joints[j].rest_offset;
      const Vector3d& rest = tracks.skeleton->joints[j].rest_offset;
      const double angle = std::atan2(own.cross(rest).norm(), own.dot(rest)) * 57.3;
      EXPECT_LT(angle, tracks.frames() == 1 ? 16.0 : 4.0) << tracks.skeleton->joints[j].name;
      if (tracks.skeleton->joints[j].parent == chest && tracks.frames() > 1) {
        EXPECT_EQ(own, rest);
      }
    }
  }
}

/// The distance between two hips does not determine whether they lie above or below the root. Observed joints of the
/// back beyond an unobserved one do.
TEST(Proportions, FindHipsByTheBackBeyondAnUnobservedJoint) {
  const SkeletonPtr nominal = *LoadSkeleton("smpl24");
  auto body = std::make_shared<Skeleton>(*nominal);
  const int left = *body->FindJoint("left_hip"), right = *body->FindJoint("right_hip");
  body->joints[left].rest_offset = {0.088, 0.044, 0.012};
  body->joints[right].rest_offset = {-0.088, 0.044, 0.012};
  PlayedTake take = SmoothTake(400, Quaterniond::Identity(), 30.0, 0.4, body);
  take.tracks.skeleton = nominal;
  const int unobserved = *body->FindJoint("spine1");
  for (int f = 0; f < 400; ++f) Hide(take.tracks, f, unobserved);
  AddNoise(take.tracks, 0.005, 5);
  const auto person = EstimateProportions({take.tracks}, nominal, ProportionsOptions{});
  EXPECT_GT(person.skeleton->joints[left].rest_offset.y(), 0.02);
  EXPECT_GT(person.skeleton->joints[right].rest_offset.y(), 0.02);
  EXPECT_NEAR(AngleBetweenJoints(*person.skeleton, left, right), AngleBetweenJoints(*body, left, right), 4.0);
}

/// Collars and neck at the chest's position are not observed. Their lengths reach from there to head and shoulders,
/// which are observed.
TEST(Proportions, SpanJointsThatRepeatTheirParentsPosition) {
  const SkeletonPtr nominal = *LoadSkeleton("smpl24");
  auto body = std::make_shared<Skeleton>(*nominal);
  const int collar = *body->FindJoint("left_collar"), shoulder = *body->FindJoint("left_shoulder");
  const int chest = *body->FindJoint("spine3");
  body->joints[collar].rest_offset.setZero();
  body->joints[body->joints[collar].mirror].rest_offset.setZero();
  body->joints[shoulder].rest_offset = {0.18, 0.07, -0.02};
  body->joints[body->joints[shoulder].mirror].rest_offset = {-0.18, 0.07, -0.02};
  PlayedTake take = SmoothTake(300, Quaterniond::Identity(), 30.0, 0.4, body);
  take.tracks.skeleton = nominal;
  const auto person = EstimateProportions({take.tracks}, nominal, ProportionsOptions{});
  ASSERT_TRUE(ShownJoints({take.tracks})[chest]);
  EXPECT_FALSE(ShownJoints({take.tracks})[collar]);
  const Skeleton& own = *person.skeleton;
  const Vector3d reached = person.bone_length[collar] * own.joints[collar].rest_offset.normalized() +
                           person.bone_length[shoulder] * own.joints[shoulder].rest_offset.normalized();
  EXPECT_NEAR(reached.norm(), 0.194, 0.02);
}

/// Hips at the pelvis's position in most frames are not observed there.
TEST(Proportions, UseOnlyFramesInWhichJointsAreObserved) {
  PlayedTake take = LargerPerson(300);
  const Skeleton& skeleton = *take.tracks.skeleton;
  for (int f = 0; f < 300; ++f) {
    if (f % 3 == 0) continue;
    for (const char* hip : {"left_hip", "right_hip"})
      take.tracks.positions.at(f, *skeleton.FindJoint(hip)) = Vector3d(take.tracks.positions.at(f, 0));
  }
  const auto person = EstimateProportions({take.tracks}, take.tracks.skeleton, ProportionsOptions{});
  const int left = *skeleton.FindJoint("left_hip");
  EXPECT_LT((person.skeleton->joints[left].rest_offset - skeleton.joints[left].rest_offset).norm(), 0.01);
}

TEST(Proportions, RoundTripThroughTheirArtifact) {
  const PlayedTake take = LargerPerson(20);
  auto person = EstimateProportions({take.tracks}, take.tracks.skeleton, ProportionsOptions{});
  person.person = "p1";
  const nlohmann::json json = ProportionsJson(person, *take.tracks.skeleton);
  EXPECT_EQ(json["person"], "p1");
  const auto read = BodyFromJson(json, take.tracks.skeleton, "p1");
  ASSERT_TRUE(read.has_value()) << read.error().Message();
  for (int j = 1; j < take.tracks.joints(); ++j) {
    const double length = read->bone_length[j];
    EXPECT_NEAR(length, person.bone_length[j], 1e-12);
    EXPECT_NEAR(std::round(length * 1e4), length * 1e4, 1e-9);  // whole tenths of a millimetre
    EXPECT_LT((read->skeleton->joints[j].rest_offset - person.skeleton->joints[j].rest_offset).norm(), 1e-12);
  }
}

TEST(Proportions, RefuseAnotherSkeleton) {
  const PlayedTake take = LargerPerson(20);
  const auto person = EstimateProportions({take.tracks}, take.tracks.skeleton, ProportionsOptions{});
  Skeleton other = *take.tracks.skeleton;
  other.name = "other";
  const auto read = BodyFromJson(ProportionsJson(person, *take.tracks.skeleton), std::make_shared<Skeleton>(other),
                                 "proportions of p1");
  ASSERT_FALSE(read.has_value());
  EXPECT_EQ(read.error().code, ErrorCode::kInconsistent);
  EXPECT_NE(read.error().what.find("test_body"), std::string::npos);
}

TEST(ProportionClips, AreIndependentOfTheirOrder) {
  std::vector<std::string> ids;
  for (int i = 0; i < 100; ++i) ids.push_back("kard/s01/clip" + std::to_string(i));
  const std::vector<std::string> chosen = ChooseProportionClips(ids);
  EXPECT_EQ(chosen.size(), static_cast<std::size_t>(kMaxProportionClips));
  std::reverse(ids.begin(), ids.end());
  EXPECT_EQ(ChooseProportionClips(ids), chosen);
}

}  // namespace
}  // namespace mocurate
