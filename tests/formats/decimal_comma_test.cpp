#include "core/formats/number_scanner.h"

#include <gtest/gtest.h>

#include "tests/formats/expect_error.h"

namespace mocurate {
namespace {

std::optional<std::string> Points(const std::string& bytes) { return WithDecimalPoints(bytes, "t.txt").value(); }

TEST(DecimalComma, IsConvertedToAPointBetweenSemicolonsOrTabs) {
  EXPECT_EQ(Points("0,5\t1,25\n-1,5\t2\n"), "0.5\t1.25\n-1.5\t2\n");
  EXPECT_EQ(Points("x,y;z\n0,5;1,25\n"), "x.y\tz\n0.5\t1.25\n") << "below a header";
  EXPECT_EQ(Points("0;0\n1,5;2\n"), "0\t0\n1.5\t2\n") << "below whole numbers";
  EXPECT_EQ(Points("1,2E-05;3,5\n0,5;1,25e+2\n"), "1.2E-05\t3.5\n0.5\t1.25e+2\n");
}

TEST(DecimalComma, IsRefusedBetweenBlanks) {
  ExpectMalformed(WithDecimalPoints("0 0\n0,5 1,25\n", "t.txt"), "t.txt:2");
}

TEST(DecimalComma, IsDistinguishedFromASeparator) {
  for (const char* text : {"1,2,3\n4,5,6\n", "12,5\n13,6\n", "1.5, 2.5\n", "1, 2\n", "1,2,3\t4,5,6\n", "1.5,2\t3\n",
                           "0 0 0\n1 2 3\n", "1,2E;3\n", "x, y\n1, 2\n", "", ","}) {
    EXPECT_EQ(Points(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace mocurate
