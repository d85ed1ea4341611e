// Axis conventions: how a source lays its axes.
#include "core/geometry/axes.h"

#include "tests/geometry/samples.h"

namespace mocurate {
namespace {

TEST(AxisConvention, ReportsWhereTheAxesOfTheSourcePoint) {
  const AxisConvention camera = AxisConvention::Parse("+x -y -z").value();
  EXPECT_EQ(camera.canonical_from_source * Vector3d(1, 2, 3), Vector3d(1, -2, -3));
  EXPECT_EQ(camera.handedness(), Handedness::kRight);
  const AxisConvention z_up = AxisConvention::Parse("+x +z -y").value();
  EXPECT_EQ(z_up.canonical_from_source * Vector3d(0, 0, 1), Vector3d(0, -1, 0));
  EXPECT_EQ(AxisConvention::Parse("-x +y +z").value().handedness(), Handedness::kLeft);
}

TEST(AxisConvention, OfAnySignedPermutationHasItsDeterminantAndItsText) {
  int count = 0;
  int left_handed = 0;
  for (const std::string order : {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"}) {
    for (int signs = 0; signs < 8; ++signs) {
      std::string text;
      for (int i = 0; i < 3; ++i) {
        if (i > 0) text += ' ';
        text += (signs >> i & 1) != 0 ? '-' : '+';
        text += order[i];
      }
      const auto convention = AxisConvention::Parse(text);
      ASSERT_TRUE(convention.has_value()) << text;
      EXPECT_EQ(convention->Text(), text);
      EXPECT_EQ(std::abs(convention->canonical_from_source.determinant()), 1.0) << text;
      EXPECT_TRUE(*convention == AxisConvention::Parse(convention->Text()).value());
      ++count;
      left_handed += convention->handedness() == Handedness::kLeft ? 1 : 0;
    }
  }
  EXPECT_EQ(count, 48);
  EXPECT_EQ(left_handed, 24);
}

TEST(AxisConvention, IsReadWithBlanksAround) {
  EXPECT_TRUE(AxisConvention::Parse("  +x\t-y  -z ").value() == AxisConvention::Parse("+x -y -z").value());
}

TEST(AxisConvention, RefusesAnythingElseWithAReason) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "has 0 axes, not 3"},        {"+x -y", "has 2 axes, not 3"},     {"+x +y +y", "names y twice"},
      {"+x +y z", "'z' is not one of"}, {"+x +y +w", "'+w' is not one of"}, {"+x +y +Z", "'+Z' is not one of"}};
  for (const auto& [text, reason] : cases) {
    const auto convention = AxisConvention::Parse(text);
    ASSERT_FALSE(convention.has_value()) << text;
    EXPECT_EQ(convention.error().code, ErrorCode::kConfig);
    EXPECT_NE(convention.error().what.find(reason), std::string::npos) << convention.error().what;
    EXPECT_NE(convention.error().hint.find("+x -y -z"), std::string::npos);
  }
}

}  // namespace
}  // namespace mocurate
