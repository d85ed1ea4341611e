// The body that is fitted to point clouds: capsules off the bones.
#include "core/body/capsule_body.h"

#include <gtest/gtest.h>

#include <memory>

#include "tests/body/stick_figure.h"

namespace mocurate {
namespace {

TEST(CapsuleBody, HasOneCapsulePerBoneWhereTheTemplateDoesNotApply) {
  const test::StickFigure figure = test::MakeStickFigure();
  const CapsuleBody body = CapsuleBody::Make(figure.skeleton, 2.0);
  ASSERT_EQ(body.capsules.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(body.capsules[i].end_joint, i + 1);
    EXPECT_EQ(body.capsules[i].frame, figure.skeleton->joints[i + 1].parent);
    EXPECT_DOUBLE_EQ(body.capsules[i].radius, 2.0 * figure.skeleton->joints[i + 1].radius);
  }
}

TEST(CapsuleBody, ACapsuleRotatesWithItsJoint) {
  BodyCapsule capsule;
  capsule.begin_offset = {0.1, 0.0, 0.0};
  capsule.end_offset = {0.0, 0.2, 0.0};
  const Matrix3d quarter = ExpMatrix(Vector3d(0.0, 0.0, 0.5 * 3.14159265358979323846));
  const CapsuleEnds ends = EndsOf(capsule, quarter, {1.0, 1.0, 1.0}, {2.0, 2.0, 2.0});
  EXPECT_LT((ends.begin - Vector3d(1.0, 1.1, 1.0)).norm(), 1e-12);
  EXPECT_LT((ends.end - Vector3d(1.8, 2.0, 2.0)).norm(), 1e-12);
}

TEST(CapsuleBody, ComesBackFromTheTextOfItsRadii) {
  const test::StickFigure figure = test::MakeStickFigure();
  std::vector<double> bones = figure.skeleton->RestBoneLengths();
  for (double& bone : bones) bone *= 1.1;
  EXPECT_NEAR(BodyScale(*figure.skeleton, bones), 1.1, 1e-12);
  CapsuleBody body = CapsuleBody::Make(figure.skeleton, 1.1);
  body.capsules[1].radius = 0.12345;
  const auto read = BodyFromRadii(figure.skeleton, bones, RadiiText(body));
  ASSERT_TRUE(read);
  ASSERT_EQ(read->capsules.size(), body.capsules.size());
  for (std::size_t i = 0; i < body.capsules.size(); ++i) {
    EXPECT_NEAR(read->capsules[i].radius, body.capsules[i].radius, 5e-5 + 1e-12);
    EXPECT_LT((read->capsules[i].end_offset - body.capsules[i].end_offset).norm(), 1e-12);
  }
}

TEST(CapsuleBody, ComesBackWithItsBodyShape) {
  auto own = std::make_shared<Skeleton>(**LoadSkeleton("smpl24"));
  const CapsuleBody usual = CapsuleBody::Make(own, 1.1);
  own->shape = {1.5, -0.5, 0.25, 2.0, -1.0};
  std::vector<double> bones = own->RestBoneLengths();
  for (double& bone : bones) bone *= 1.1;
  const CapsuleBody body = CapsuleBody::Make(own, 1.1);
  const auto read = BodyFromRadii(*LoadSkeleton("smpl24"), bones, RadiiText(body));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->skeleton->shape, own->shape);
  double moved = 0.0;
  for (std::size_t i = 0; i < body.capsules.size(); ++i) {
    EXPECT_LT((read->capsules[i].begin_offset - body.capsules[i].begin_offset).norm(), 1e-12);
    moved = std::max(moved, (usual.capsules[i].begin_offset - body.capsules[i].begin_offset).norm());
  }
  EXPECT_GT(moved, 0.005) << "another body shape moves the capsules";
}

TEST(CapsuleBody, HasEveryCapsuleOfASideOnTheOtherSideToo) {
  auto own = std::make_shared<Skeleton>(**LoadSkeleton("smpl24"));
  own->shape = {1.0, 1.0, 1.0, 1.0, 1.0};
  const CapsuleBody body = CapsuleBody::Make(own, 1.0);
  const Vector3d mirror(-1.0, 1.0, 1.0);
  for (std::size_t i = 0; i < body.capsules.size(); ++i) {
    const BodyCapsule& one = body.capsules[i];
    const BodyCapsule& other = body.capsules[static_cast<std::size_t>(one.mirror)];
    EXPECT_EQ(other.mirror, static_cast<int>(i));
    EXPECT_EQ(own->joints[one.frame].mirror, other.frame);
    const bool is_sided = own->joints[one.frame].mirror != one.frame;
    EXPECT_EQ(one.mirror != static_cast<int>(i), is_sided);
    if (!is_sided) continue;
    EXPECT_EQ(other.begin_offset, one.begin_offset.cwiseProduct(mirror));
    EXPECT_EQ(other.end_offset, one.end_offset.cwiseProduct(mirror));
    EXPECT_EQ(other.radius, one.radius);
  }
}

TEST(CapsuleBody, ATextOfAnotherBodyIsRefused) {
  const test::StickFigure figure = test::MakeStickFigure();
  const std::vector<double> bones = figure.skeleton->RestBoneLengths();
  for (const char* radii : {"", "0.1 0.1", "0.1 0.1 0.1 0.1", "0.1 wide 0.1", "0.1 -0.1 0.1", "0.1 0 0.1"}) {
    EXPECT_FALSE(BodyFromRadii(figure.skeleton, bones, radii)) << radii;
  }
}

}  // namespace
}  // namespace mocurate
