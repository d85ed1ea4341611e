// Alignment of paired points with outliers.
#include "core/geometry/rigid.h"

#include "tests/geometry/samples.h"

namespace mocurate {
namespace {

using test::DrawRotation;
using test::DrawVector;

TEST(RobustAlignment, AThirdOfForeignPairsDoesNotMoveIt) {
  Random random(50, "robust");
  for (int trial = 0; trial < 20; ++trial) {
    const RigidTransform truth{DrawRotation(random), DrawVector(random)};
    Eigen::Matrix3Xd source(3, 300), target(3, 300);
    for (Eigen::Index i = 0; i < 300; ++i) {
      source.col(i) = 0.5 * DrawVector(random);
      target.col(i) = truth * Vector3d(source.col(i)) + 0.002 * DrawVector(random);
      if (i % 3 == 0) target.col(i) += Vector3d(0.8, 0.3, 0.0) + 0.4 * DrawVector(random);
    }
    const RobustAlignment fit = AlignPointsRobustly(source, target, Eigen::VectorXd::Ones(300), 0.002);
    EXPECT_LT((fit.target_from_source.translation - truth.translation).norm(), 0.002);
    EXPECT_LT(AngleBetween(fit.target_from_source.rotation, truth.rotation), 0.003);
    EXPECT_GT(fit.share, 0.6);
    EXPECT_LT(fit.share, 0.72);
    const RigidTransform plain = AlignPoints(source, target, Eigen::VectorXd::Ones(300));
    EXPECT_GT((plain.translation - truth.translation).norm(), 0.1) << "least squares follows them";
  }
}

TEST(RobustAlignment, PairsWithoutWeightAreNotRead) {
  Random random(51, "robust");
  const RigidTransform truth{DrawRotation(random), DrawVector(random)};
  Eigen::Matrix3Xd source(3, 40), target(3, 40);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(40);
  for (Eigen::Index i = 0; i < 40; ++i) {
    source.col(i) = DrawVector(random);
    target.col(i) = truth * Vector3d(source.col(i));
    if (i < 30) continue;
    target.col(i).setConstant(1e6);
    weights[i] = 0.0;
  }
  const RobustAlignment fit = AlignPointsRobustly(source, target, weights);
  EXPECT_LT(fit.median, 1e-12);
  EXPECT_NEAR(fit.share, 1.0, 1e-12);
}

TEST(RobustAlignment, PointsOnALineAreKnownByTheirSpread) {
  Eigen::Matrix3Xd line(3, 10);
  for (Eigen::Index i = 0; i < 10; ++i) line.col(i) = Vector3d(0.1 * static_cast<double>(i), 0.0, 0.0);
  EXPECT_LT(AlignPointsRobustly(line, line, Eigen::VectorXd::Ones(10)).spread, 1e-9);
}

}  // namespace
}  // namespace mocurate
