// Rigid transforms and the alignment of paired points.
#include "core/geometry/rigid.h"

#include "tests/geometry/samples.h"

namespace mocurate {
namespace {

using test::Difference;
using test::DrawDirection;
using test::DrawRotation;
using test::DrawVector;
using test::kPi;

RigidTransform DrawTransform(Random& random) { return {DrawRotation(random), DrawVector(random)}; }

Eigen::Matrix3Xd DrawPoints(Random& random, int count) {
  Eigen::Matrix3Xd points(3, count);
  for (int i = 0; i < count; ++i) points.col(i) = DrawVector(random);
  return points;
}

Eigen::Matrix3Xd Apply(const RigidTransform& transform, const Eigen::Matrix3Xd& points) {
  Eigen::Matrix3Xd moved(3, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) moved.col(i) = transform * Vector3d(points.col(i));
  return moved;
}

TEST(RigidTransform, ComposesRightToLeft) {
  Random random(30, "rigid");
  for (int i = 0; i < 100; ++i) {
    const RigidTransform c_from_b = DrawTransform(random);
    const RigidTransform b_from_a = DrawTransform(random);
    const Vector3d point = DrawVector(random);
    EXPECT_LT(Difference((c_from_b * b_from_a) * point, c_from_b * (b_from_a * point)), 1e-14);
  }
}

TEST(RigidTransform, IsUndoneByItsInverse) {
  Random random(31, "rigid");
  for (int i = 0; i < 100; ++i) {
    const RigidTransform b_from_a = DrawTransform(random);
    const Vector3d point = DrawVector(random);
    EXPECT_LT(Difference(Inverse(b_from_a) * (b_from_a * point), point), 1e-14);
    EXPECT_LT(Difference(Inverse(Inverse(b_from_a)).translation, b_from_a.translation), 4e-15);
    EXPECT_EQ(Inverse(Inverse(b_from_a)).rotation.coeffs(), b_from_a.rotation.coeffs());
  }
}

TEST(Alignment, FindsTheTransformBetweenPairedPoints) {
  Random random(32, "align");
  for (int i = 0; i < 100; ++i) {
    const RigidTransform truth = DrawTransform(random);
    const Eigen::Matrix3Xd source = DrawPoints(random, 3 + i % 10);
    Eigen::VectorXd weights(source.cols());
    for (Eigen::Index k = 0; k < weights.size(); ++k) weights[k] = random.Uniform(0.1, 2.0);
    const RigidTransform found = AlignPoints(source, Apply(truth, source), weights);
    EXPECT_LT(Difference(Apply(found, source), Apply(truth, source)), 1e-13);
    EXPECT_LT(AngleBetween(found.rotation, truth.rotation), 1e-12);
  }
}

TEST(Alignment, NeverMirrorsAndNoRotationNearbyIsBetter) {
  Random random(33, "align noise");
  for (int i = 0; i < 100; ++i) {
    const Eigen::Matrix3Xd source = DrawPoints(random, 6);
    Eigen::Matrix3Xd target = source;
    target.row(0) *= -1.0;  // the best orthogonal map is a mirror
    const Eigen::VectorXd weights = Eigen::VectorXd::Ones(6);
    const RigidTransform found = AlignPoints(source, target, weights);
    EXPECT_TRUE(test::IsRotation(found.rotation.toRotationMatrix()));
    const double best = (Apply(found, source) - target).squaredNorm();
    for (int k = 0; k < 20; ++k) {
      RigidTransform other = found;
      other.rotation = found.rotation * ExpQuaternion(0.01 * DrawVector(random));
      other.translation = target.rowwise().mean() - other.rotation * Vector3d(source.rowwise().mean());
      EXPECT_LE(best, (Apply(other, source) - target).squaredNorm() + 1e-12);
    }
  }
}

TEST(Alignment, IgnoresPointsOfWeightZero) {
  Random random(34, "align weights");
  const RigidTransform truth = DrawTransform(random);
  const Eigen::Matrix3Xd source = DrawPoints(random, 6);
  Eigen::Matrix3Xd target = Apply(truth, source);
  target.col(2) = Vector3d(100.0, -100.0, 3.0);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(6);
  weights[2] = 0.0;
  EXPECT_LT(AngleBetween(AlignPoints(source, target, weights).rotation, truth.rotation), 1e-12);
}

TEST(Alignment, OfPointsOnALineIsTheSmallestRotation) {
  Random random(35, "align line");
  for (int i = 0; i < 100; ++i) {
    const Vector3d from = DrawDirection(random);
    const Vector3d to = i == 0 ? Vector3d(-from) : DrawDirection(random);
    const Vector3d offset = 3.0 * DrawVector(random);
    Eigen::Matrix3Xd source(3, 4);
    Eigen::Matrix3Xd target(3, 4);
    for (int k = 0; k < 4; ++k) {
      const double along = k == 3 ? 2.5 : k;
      source.col(k) = offset + along * from;
      target.col(k) = along * to - offset;
    }
    const RigidTransform found = AlignPoints(source, target, Eigen::VectorXd::Ones(4));
    EXPECT_LT(Difference(Apply(found, source), target), 1e-13);
    EXPECT_NEAR(AngleBetween(found.rotation, Quaterniond::Identity()), std::acos(from.dot(to)), 1e-7);
  }
}

TEST(Alignment, OfASinglePointIsATranslation) {
  const Eigen::Matrix3Xd source = Vector3d(1, 2, 3).replicate(1, 2);
  const Eigen::Matrix3Xd target = Vector3d(-1, 0.1, 3).replicate(1, 2);
  const RigidTransform found = AlignPoints(source, target, Eigen::VectorXd::Constant(2, 0.7));
  EXPECT_EQ(found.rotation.coeffs(), Quaterniond::Identity().coeffs());
  EXPECT_LT(Difference(found.translation, Vector3d(-2, -1.9, 0)), 4e-15);
}

}  // namespace
}  // namespace mocurate
