// Distances to capsules and points on them.
#include "core/body/bone_capsules.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "tests/body/stick_figure.h"

namespace mocurate {
namespace {

Vector3d DrawVector(Random& random) { return Vector3d(random.Normal(), random.Normal(), random.Normal()); }

TEST(BoneCapsules, HasOneCapsulePerBone) {
  const test::StickFigure figure = test::MakeStickFigure();
  const BoneCapsules body = BoneCapsules::Make(figure.skeleton, 1.5);
  ASSERT_EQ(body.capsules.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const Capsule& capsule = body.capsules[i];
    EXPECT_EQ(capsule.joint, i + 1);
    EXPECT_EQ(capsule.parent, figure.skeleton->joints[i + 1].parent);
    EXPECT_DOUBLE_EQ(capsule.radius, 1.5 * figure.skeleton->joints[i + 1].radius);
  }
}

TEST(BoneCapsules, HasNoCapsuleForAJointWithoutRadius) {
  Skeleton skeleton = *test::MakeStickFigure().skeleton;
  skeleton.joints[2].radius = 0.0;
  const BoneCapsules body = BoneCapsules::Make(std::make_shared<const Skeleton>(skeleton));
  ASSERT_EQ(body.capsules.size(), 2u);
  EXPECT_EQ(body.capsules[1].joint, 3);
}

TEST(CapsuleDistance, IsThatOfTheBoneLessTheRadius) {
  const Vector3d a(0, 0, 0);
  const Vector3d b(0, 2, 0);
  EXPECT_NEAR(SignedDistance(a, b, 0.1, Vector3d(1, 1, 0)), 0.9, 1e-15);
  EXPECT_NEAR(SignedDistance(a, b, 0.1, Vector3d(0, 3, 0)), 0.9, 1e-15);
  EXPECT_NEAR(SignedDistance(a, b, 0.1, Vector3d(3, -4, 0)), 4.9, 1e-15);
  EXPECT_NEAR(SignedDistance(a, b, 0.1, Vector3d(0, 1, 0)), -0.1, 1e-15);
  EXPECT_NEAR(SignedDistance(a, a, 0.1, Vector3d(0, 1, 0)), 0.9, 1e-15);
}

TEST(CapsuleDistance, BelongsToThePointItNames) {
  Random random(1, "capsules");
  for (int i = 0; i < 500; ++i) {
    const Vector3d a = DrawVector(random);
    const Vector3d b = i % 10 == 0 ? a : DrawVector(random);
    const Vector3d point = DrawVector(random);
    const double radius = random.Uniform(0.05, 0.8);
    const CapsulePoint closest = ClosestOnCapsule(a, b, radius, point);
    EXPECT_NEAR(closest.distance, SignedDistance(a, b, radius, point), 1e-14);
    EXPECT_NEAR((point - closest.point).norm(), std::abs(closest.distance), 1e-14);
    EXPECT_NEAR(closest.normal.norm(), 1.0, 1e-14);
    EXPECT_LT((closest.point + closest.distance * closest.normal - point).norm(), 1e-14);
    EXPECT_NEAR(SignedDistance(a, b, radius, closest.point), 0.0, 1e-14);
    // No other point of the surface is nearer.
    for (int k = 0; k < 10; ++k) {
      const Vector3d other = ClosestOnCapsule(a, b, radius, 2.0 * DrawVector(random)).point;
      EXPECT_GE((other - point).norm(), std::abs(closest.distance) - 1e-12);
    }
  }
}

TEST(CapsuleDistance, OnTheBoneHasAFixedNormalAcrossIt) {
  const Vector3d a(1, 2, 3);
  const Vector3d b(1, 2, 5);
  const CapsulePoint closest = ClosestOnCapsule(a, b, 0.2, Vector3d(1, 2, 4));
  EXPECT_DOUBLE_EQ(closest.distance, -0.2);
  EXPECT_DOUBLE_EQ(closest.fraction, 0.5);
  EXPECT_NEAR(closest.normal.dot(b - a), 0.0, 1e-15);
  EXPECT_TRUE(ClosestOnCapsule(a, a, 0.2, a).point.allFinite());
}

TEST(Body, AssignsAPointToItsNearestCapsule) {
  const test::StickFigure figure = test::MakeStickFigure();
  const BoneCapsules body = BoneCapsules::Make(figure.skeleton);
  const auto at_hand = ClosestOnBody(body, figure.joints.data(), Vector3d(0.4, 0.7, 0.0));
  ASSERT_TRUE(at_hand.has_value());
  EXPECT_EQ(at_hand->capsule, 1);
  EXPECT_NEAR(at_hand->on_capsule.distance, 0.06, 1e-15);
  EXPECT_NEAR(at_hand->on_capsule.fraction, 0.8, 1e-15);
  EXPECT_EQ(ClosestOnBody(body, figure.joints.data(), Vector3d(0.3, 0.1, 0.0))->capsule, 0);
  EXPECT_EQ(ClosestOnBody(body, figure.joints.data(), Vector3d(-0.6, 0.6, 0.0))->capsule, 2);
  EXPECT_FALSE(ClosestOnBody(BoneCapsules{}, figure.joints.data(), Vector3d::Zero()).has_value());
}

}  // namespace
}  // namespace mocurate
