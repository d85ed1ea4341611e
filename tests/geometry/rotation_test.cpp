// Interpolation, swings, projections onto rotations, 6D representations.
#include "tests/geometry/samples.h"
#include "tests/support/rotations.h"

namespace mocurate {
namespace {

using test::Difference;
using test::DrawDirection;
using test::DrawRotation;
using test::DrawVector;
using test::kPi;
using test::Text;

Matrix3d QuarterTurnAboutZ() { return ExpMatrix(Vector3d(0, 0, kPi / 2.0)); }

TEST(Hat, IsTheCrossProduct) {
  Random random(10, "hat");
  for (int i = 0; i < 100; ++i) {
    const Vector3d a = DrawVector(random);
    const Vector3d b = DrawVector(random);
    EXPECT_LT(Difference(Hat(a) * b, a.cross(b)), 4e-15);
  }
}

TEST(Slerp, StartsAtTheFirstAndEndsAtTheSecondRotation) {
  Random random(11, "slerp");
  for (int i = 0; i < 200; ++i) {
    const Quaterniond a = DrawRotation(random);
    const Quaterniond b = DrawRotation(random);
    EXPECT_EQ(Slerp(a, b, 0.0).coeffs(), a.coeffs());
    EXPECT_EQ(AngleBetween(Slerp(a, b, 1.0), b), 0.0);
    EXPECT_LT(AngleBetween(Slerp(a, b, 1.0 - 1e-12), b), 1e-11);
  }
}

TEST(Slerp, RotatesEvenlyAlongTheShorterArc) {
  Random random(12, "slerp");
  for (int i = 0; i < 200; ++i) {
    const Quaterniond a = DrawRotation(random);
    const Quaterniond b = DrawRotation(random);
    const double angle = AngleBetween(a, b);
    EXPECT_LE(angle, kPi);
    for (const double t : {0.1, 0.25, 0.5, 0.9}) {
      EXPECT_NEAR(AngleBetween(a, Slerp(a, b, t)), t * angle, 1e-14);
      EXPECT_NEAR(AngleBetween(Slerp(a, b, t), b), (1.0 - t) * angle, 1e-14);
    }
  }
}

TEST(AngleBetween, IsExactForTinyAngles) {
  Random random(13, "angle");
  const Quaterniond a = Quaterniond::Identity();
  for (const double angle : {1e-300, 1e-12, 1e-8, 1.0, kPi - 1e-9}) {
    EXPECT_NEAR(AngleBetween(a, ExpQuaternion(angle * DrawDirection(random))), angle, 1e-15 * angle);
  }
}

TEST(NearestRotation, KeepsRotationsAndCorrectsPerturbedOnes) {
  Random random(14, "nearest");
  for (int i = 0; i < 200; ++i) {
    const Matrix3d r = DrawRotation(random).toRotationMatrix();
    EXPECT_LT(Difference(NearestRotation(r), r), 3e-15);
    Matrix3d noise;
    for (int k = 0; k < 9; ++k) noise(k) = 0.2 * random.Normal();
    const Matrix3d nearest = NearestRotation(r + noise);
    ASSERT_TRUE(test::IsRotation(nearest));
    // No rotation nearby is nearer.
    for (int k = 0; k < 20; ++k) {
      const Matrix3d other = nearest * ExpMatrix(0.01 * DrawVector(random));
      EXPECT_LE((nearest - r - noise).norm(), (other - r - noise).norm() + 1e-14);
    }
  }
  EXPECT_TRUE(test::IsRotation(NearestRotation(-Matrix3d::Identity())));
  EXPECT_TRUE(test::IsRotation(NearestRotation(Matrix3d::Zero())));
}

TEST(Swing, TakesOneDirectionToTheOtherWithoutTwist) {
  Random random(15, "swing");
  std::vector<Vector3d> directions = test::Axes();
  for (const Vector3d& from : directions) {
    for (const double angle : test::AnglesBelowPi()) {
      Vector3d side = DrawDirection(random);
      side = (side - side.dot(from) * from).normalized();
      const Vector3d to = std::cos(angle) * from + std::sin(angle) * side;
      const Quaterniond swing = SwingBetween(2.0 * from, 0.1 * to);
      EXPECT_NEAR(swing.norm(), 1.0, 4e-15);
      EXPECT_LT(Difference(swing * from, to), 1e-14) << angle << " from " << Text(from);
      EXPECT_NEAR(swing.vec().dot(from), 0.0, 4e-15) << angle << " from " << Text(from);
    }
  }
}

TEST(Swing, OfOppositeDirectionsIsAlwaysTheSameRotationByPi) {
  for (const Vector3d& from : test::Axes()) {
    const Quaterniond swing = SwingBetween(from, -from);
    EXPECT_NEAR(AngleBetween(Quaterniond::Identity(), swing), kPi, 4e-15);
    EXPECT_LT(Difference(swing * from, -from), 4e-15);
    EXPECT_NEAR(swing.vec().dot(from), 0.0, 4e-15);
    EXPECT_EQ(swing.coeffs(), SwingBetween(from, -from).coeffs());
    EXPECT_EQ(SwingBetween(from, from).coeffs(), Quaterniond::Identity().coeffs());
  }
}

TEST(Swing, OfAZeroVectorIsTheIdentity) {
  EXPECT_EQ(SwingBetween(Vector3d::Zero(), Vector3d::UnitX()).coeffs(), Quaterniond::Identity().coeffs());
  EXPECT_EQ(SwingBetween(Vector3d::UnitX(), Vector3d::Zero()).coeffs(), Quaterniond::Identity().coeffs());
}

TEST(SixNumbers, AreTheFirstTwoRowsOrTheInterleavedFirstTwoColumns) {
  const std::array<double, 6> rows = Matrix6D(QuarterTurnAboutZ(), Rotation6D::kRows);
  const std::array<double, 6> columns = Matrix6D(QuarterTurnAboutZ(), Rotation6D::kColumns);
  const std::array<double, 6> expected_rows{0, -1, 0, 1, 0, 0};
  const std::array<double, 6> expected_columns{0, -1, 1, 0, 0, 0};
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(rows[i], expected_rows[i], 4e-15) << i;
    EXPECT_NEAR(columns[i], expected_columns[i], 4e-15) << i;
  }
}

TEST(SixNumbers, GiveTheMatrixBackInTheirOwnLayout) {
  for (const Vector3d& w : test::RotationVectors()) {
    const Matrix3d r = ExpMatrix(w);
    for (const Rotation6D layout : {Rotation6D::kRows, Rotation6D::kColumns}) {
      EXPECT_LT(Difference(MatrixFrom6D(Matrix6D(r, layout), layout), r), 4e-15) << Text(w);
    }
  }
}

TEST(SixNumbers, OfANetworkBecomeARotationUnlessTheyAreDegenerate) {
  Random random(16, "six");
  for (int i = 0; i < 200; ++i) {
    std::array<double, 6> values;
    for (double& v : values) v = random.Normal();
    EXPECT_TRUE(test::IsRotation(MatrixFrom6D(values, Rotation6D::kRows)));
    EXPECT_TRUE(test::IsRotation(MatrixFrom6D(values, Rotation6D::kColumns)));
  }
  EXPECT_EQ(MatrixFrom6D({0, 0, 0, 0, 0, 0}, Rotation6D::kRows), Matrix3d::Zero());
  EXPECT_TRUE(MatrixFrom6D({1, 0, 0, 1, 0, 0}, Rotation6D::kRows).allFinite());
}

TEST(SignContinuity, FlipsQuaternionsIntoOneHemisphere) {
  // Two joints interleaved; only the first is made continuous.
  std::vector<Quaterniond> rotations;
  for (int frame = 0; frame < 50; ++frame) {
    const double sign = frame % 3 == 0 ? -1.0 : 1.0;
    for (int joint = 0; joint < 2; ++joint) {
      Quaterniond q = ExpQuaternion(Vector3d(0.0, 0.2 * frame, 0.1));
      q.coeffs() *= sign;
      rotations.push_back(q);
    }
  }
  const std::vector<Quaterniond> before = rotations;
  MakeSignContinuous(rotations.data(), 50, 2);
  EXPECT_GE(rotations[0].w(), 0.0);
  for (int frame = 0; frame < 50; ++frame) {
    EXPECT_EQ(AngleBetween(rotations[2 * frame], before[2 * frame]), 0.0);
    EXPECT_EQ(rotations[2 * frame + 1].coeffs(), before[2 * frame + 1].coeffs());
    if (frame > 0) {
      EXPECT_GE(rotations[2 * frame].dot(rotations[2 * frame - 2]), 0.0) << frame;
    }
  }
}

}  // namespace
}  // namespace mocurate
