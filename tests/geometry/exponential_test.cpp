// Laws of the exponential map, its inverse and its Jacobians.
#include "tests/geometry/samples.h"

namespace mocurate {
namespace {

using test::Difference;
using test::DrawRotation;
using test::DrawVector;
using test::kPi;
using test::Text;

TEST(Exponential, YieldsARotationForAnyVector) {
  for (const Vector3d& w : test::RotationVectors()) {
    EXPECT_TRUE(test::IsRotation(ExpMatrix(w))) << Text(w);
    EXPECT_NEAR(ExpQuaternion(w).norm(), 1.0, 4e-15) << Text(w);
    EXPECT_LT(Difference(ExpQuaternion(w).toRotationMatrix(), ExpMatrix(w)), 4e-15) << Text(w);
  }
}

TEST(Exponential, EqualsTheMatrixSeries) {
  for (const Vector3d& w : test::RotationVectors()) {
    if (w.norm() > 10.0) continue;
    // exp(A) = exp(A / 1024)^1024, the inner one by its power series.
    const Matrix3d step = Hat(w) / 1024.0;
    Matrix3d term = Matrix3d::Identity();
    Matrix3d power = Matrix3d::Identity();
    for (int n = 1; n < 15; ++n) {
      term = term * step / n;
      power += term;
    }
    for (int n = 0; n < 10; ++n) power = power * power;
    EXPECT_LT(Difference(ExpMatrix(w), power), 1e-12) << Text(w);
  }
}

TEST(Exponential, IsTheIdentityPlusTheVectorWhenTiny) {
  const Vector3d w(1e-300, -2e-300, 3e-301);
  const Quaterniond q = ExpQuaternion(w);
  EXPECT_EQ(q.w(), 1.0);
  EXPECT_EQ(q.vec(), 0.5 * w);
  EXPECT_EQ(ExpMatrix(w)(2, 1), 1e-300);
  EXPECT_EQ(ExpMatrix(Vector3d::Zero()), Matrix3d::Identity());
}

TEST(Logarithm, InvertsTheExponentialBelowPi) {
  for (const Vector3d& w : test::RotationVectorsBelowPi()) {
    const double tolerance = 4e-16 * std::max(w.norm(), 1e-300);
    EXPECT_LE(Difference(LogQuaternion(ExpQuaternion(w)), w), 4.0 * tolerance) << Text(w);
    // A matrix near pi holds the angle in its skew part and the axis in its diagonal: absolute rounding of 1.
    const double rounding = w.norm() < 1e-3 ? 4.0 * tolerance : 1e-14;
    EXPECT_LE(Difference(LogMatrix(ExpMatrix(w)), w), rounding) << Text(w);
  }
}

TEST(Logarithm, GivesBackEveryRotation) {
  for (const Vector3d& w : test::RotationVectors()) {
    const Vector3d from_quaternion = LogQuaternion(ExpQuaternion(w));
    const Vector3d from_matrix = LogMatrix(ExpMatrix(w));
    EXPECT_LE(from_quaternion.norm(), kPi + 1e-15) << Text(w);
    EXPECT_LE(from_matrix.norm(), kPi + 1e-15) << Text(w);
    EXPECT_LT(Difference(ExpMatrix(from_quaternion), ExpMatrix(w)), 1e-14) << Text(w);
    EXPECT_LT(Difference(ExpMatrix(from_matrix), ExpMatrix(w)), 1e-14) << Text(w);
  }
  Random random(2, "rotations");
  for (int i = 0; i < 1000; ++i) {
    const Matrix3d r = DrawRotation(random).toRotationMatrix();
    EXPECT_LT(Difference(ExpMatrix(LogMatrix(r)), r), 4e-15);
  }
}

TEST(Logarithm, DoesNotDependOnTheSignOfTheQuaternion) {
  Random random(3, "rotations");
  for (int i = 0; i < 200; ++i) {
    const Quaterniond q = DrawRotation(random);
    EXPECT_EQ(LogQuaternion(q), LogQuaternion(Quaterniond(-q.coeffs())));
  }
}

TEST(Logarithm, OfARotationByPiHasAPositiveFirstComponent) {
  for (const Vector3d& axis : test::Axes()) {
    const Quaterniond half_turn(0.0, axis.x(), axis.y(), axis.z());
    const Vector3d w = LogQuaternion(half_turn);
    EXPECT_NEAR(w.norm(), kPi, 4e-15);
    EXPECT_LT(Difference(ExpMatrix(w), half_turn.toRotationMatrix()), 4e-15) << Text(axis);
    for (int i = 0; i < 3; ++i) {
      if (std::abs(w[i]) < 1e-9) continue;
      EXPECT_GT(w[i], 0.0) << Text(axis);
      break;
    }
    EXPECT_EQ(w, LogQuaternion(Quaterniond(-half_turn.coeffs())));
    EXPECT_LT(Difference(w, LogMatrix(2.0 * axis * axis.transpose() - Matrix3d::Identity())), 1e-14) << Text(axis);
  }
}

TEST(Jacobians, EqualNumericDifferences) {
  const double step = 1e-6;
  for (const Vector3d& w : test::RotationVectorsBelowPi()) {
    Matrix3d right;
    for (int i = 0; i < 3; ++i) {
      const Quaterniond plus = ExpQuaternion(w + step * Vector3d::Unit(i));
      const Quaterniond minus = ExpQuaternion(w - step * Vector3d::Unit(i));
      right.col(i) = LogQuaternion(minus.conjugate() * plus) / (2.0 * step);
    }
    EXPECT_LT(Difference(RightJacobian(w), right), 1e-9) << Text(w);
  }
}

TEST(Jacobians, KeepTheirLaws) {
  for (const Vector3d& w : test::RotationVectors()) {
    EXPECT_LT(Difference(RightJacobian(w).transpose(), RightJacobian(-w)), 4e-15) << Text(w);
    EXPECT_LT(Difference(RightJacobian(w).transpose(), ExpMatrix(w) * RightJacobian(w)), 1e-13) << Text(w);
    if (w.norm() > 6.2) continue;
    EXPECT_LT(Difference(RightJacobianInverse(w) * RightJacobian(w), Matrix3d::Identity()), 1e-12) << Text(w);
  }
}

TEST(Unwrapping, KeepsTheRotationAndComesNearestToThePreviousVector) {
  Random random(4, "unwrap");
  for (int i = 0; i < 500; ++i) {
    const Vector3d w = LogQuaternion(DrawRotation(random));
    const Vector3d previous = 6.0 * DrawVector(random);
    const Vector3d nearest = UnwrapNear(w, previous);
    EXPECT_LT(Difference(ExpMatrix(nearest), ExpMatrix(w)), 1e-13);
    for (int turns = -6; turns <= 6; ++turns) {
      const Vector3d other = (w.norm() + 2.0 * kPi * turns) * w.normalized();
      EXPECT_LE((nearest - previous).norm(), (other - previous).norm() + 1e-12);
    }
  }
}

TEST(Unwrapping, FollowsAJointThatRotatesPastPiAndTwoPi) {
  Vector3d previous = Vector3d::Zero();
  const Vector3d axis = Vector3d(1, -2, 3).normalized();
  for (double angle = 0.0; angle < 20.0; angle += 0.1) {
    previous = UnwrapNear(LogQuaternion(ExpQuaternion(angle * axis)), previous);
    ASSERT_LT(Difference(previous, angle * axis), 1e-12) << angle;
  }
  EXPECT_LT(Difference(UnwrapNear(Vector3d::Zero(), Vector3d(0, 6.2, 0)), Vector3d(0, 2.0 * kPi, 0)), 4e-15);
  EXPECT_EQ(UnwrapNear(Vector3d::Zero(), Vector3d(0, 0.2, 0)), Vector3d::Zero());
}

}  // namespace
}  // namespace mocurate
