// Euler angles of every sequence.
#include "tests/geometry/samples.h"
#include "tests/support/rotations.h"

namespace mocurate {
namespace {

using test::Difference;
using test::kPi;
using test::Text;

const char* const kOrders[] = {"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX", "XYX", "XZX", "YXY", "YZY", "ZXZ", "ZYZ"};

EulerOrder Order(const char* text) { return EulerOrder::Parse(text).value(); }

bool IsProper(const EulerOrder& order) { return order.axes[0] == order.axes[2]; }

class EulerSequence : public testing::TestWithParam<const char*> {};

TEST_P(EulerSequence, IsTheProductOfRotationsAboutItsAxes) {
  const EulerOrder order = Order(GetParam());
  Matrix3d product = Matrix3d::Identity();
  const Vector3d angles(0.3, -1.1, 2.2);
  for (int i = 0; i < 3; ++i) product = product * ExpMatrix(angles[i] * Vector3d::Unit(order.axes[i]));
  EXPECT_LT(Difference(MatrixFromEuler(angles, order), product), 4e-15);
}

TEST_P(EulerSequence, GivesBackAnyRotationWithAnglesInRange) {
  const EulerOrder order = Order(GetParam());
  for (const Vector3d& w : test::RotationVectors()) {
    const Matrix3d r = ExpMatrix(w);
    const Vector3d angles = EulerFromMatrix(r, order);
    ASSERT_LT(Difference(MatrixFromEuler(angles, order), r), 2e-12) << Text(w) << "-> " << Text(angles);
    for (const int i : {0, 2}) {
      EXPECT_LE(angles[i], kPi);
      EXPECT_GT(angles[i], -kPi);
    }
    EXPECT_LE(angles[1], IsProper(order) ? kPi : kPi / 2.0);
    EXPECT_GE(angles[1], IsProper(order) ? 0.0 : -kPi / 2.0);
  }
}

TEST_P(EulerSequence, GivesBackItsOwnAngles) {
  const EulerOrder order = Order(GetParam());
  Random random(20, "euler", GetParam());
  for (int i = 0; i < 300; ++i) {
    const double centre = IsProper(order) ? kPi / 2.0 : 0.0;
    const Vector3d angles(random.Uniform(-kPi, kPi), centre + random.Uniform(-1.5, 1.5), random.Uniform(-kPi, kPi));
    EXPECT_LT(Difference(EulerFromMatrix(MatrixFromEuler(angles, order), order), angles), 1e-13) << Text(angles);
  }
}

TEST_P(EulerSequence, PutsTheWholeRotationIntoTheFirstAngleInGimbalLock) {
  const EulerOrder order = Order(GetParam());
  Random random(21, "gimbal", GetParam());
  for (int i = 0; i < 100; ++i) {
    for (const double middle : {-kPi / 2.0, 0.0, kPi / 2.0, kPi}) {
      const bool locks = IsProper(order) ? middle == 0.0 || middle == kPi : std::abs(middle) == kPi / 2.0;
      if (!locks) continue;
      const Matrix3d r = MatrixFromEuler(Vector3d(random.Uniform(-kPi, kPi), middle, random.Uniform(-kPi, kPi)), order);
      const Vector3d angles = EulerFromMatrix(r, order);
      EXPECT_EQ(angles[2], 0.0);
      EXPECT_NEAR(angles[1], middle, 4e-15);
      EXPECT_LT(Difference(MatrixFromEuler(angles, order), r), 1e-12);
    }
  }
}

TEST_P(EulerSequence, StaysExactNextToGimbalLock) {
  const EulerOrder order = Order(GetParam());
  Random random(22, "near gimbal", GetParam());
  const double lock = IsProper(order) ? 0.0 : kPi / 2.0;
  for (const double away : {1e-15, 1e-13, 1e-12, 1e-11, 1e-9, 1e-8, 1e-6, 1e-3}) {
    for (int i = 0; i < 100; ++i) {
      const Vector3d given(random.Uniform(-kPi, kPi), IsProper(order) ? away : lock - away, random.Uniform(-kPi, kPi));
      const Matrix3d r = MatrixFromEuler(given, order);
      EXPECT_LT(Difference(MatrixFromEuler(EulerFromMatrix(r, order), order), r), 2e-12) << away;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(AllOrders, EulerSequence, testing::ValuesIn(kOrders),
                         [](const auto& parameter) { return std::string(parameter.param); });

TEST(EulerOrder, IsThreeAxesNoneTwiceInARow) {
  EXPECT_EQ(Order("ZXY").axes, (std::array<int, 3>{2, 0, 1}));
  EXPECT_TRUE(Order("zxy") == Order("ZXY"));
  EXPECT_FALSE(Order("ZXY") == Order("ZYX"));
  for (const char* wrong : {"", "XY", "XYZX", "XXY", "XYY", "XAZ"}) {
    const auto order = EulerOrder::Parse(wrong);
    ASSERT_FALSE(order.has_value()) << wrong;
    EXPECT_EQ(order.error().code, ErrorCode::kConfig);
    EXPECT_NE(order.error().what.find("'" + std::string(wrong) + "'"), std::string::npos) << order.error().what;
    EXPECT_FALSE(order.error().hint.empty());
  }
}

}  // namespace
}  // namespace mocurate
