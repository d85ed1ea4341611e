#include "core/formats/decimal_comma.h"

#include <gtest/gtest.h>

namespace mocurate {
namespace {

TEST(DecimalComma, IsConvertedToAPointInATable) {
  EXPECT_EQ(WithDecimalPoints("0,5 1,25\n-1,5\t2\n"), "0.5 1.25\n-1.5\t2\n");
  EXPECT_EQ(WithDecimalPoints("x y\n0,5;1,25\n"), "x y\n0.5 1.25\n")
      << "a table with a header, separated by semicolons";
}

TEST(DecimalComma, IsNotDetectedInRowsOfIntegers) {
  EXPECT_EQ(WithDecimalPoints("0 0 0\n1,5 2 3\n0 0 0\n1 2,5 3\n"), "0 0 0\n1.5 2 3\n0 0 0\n1 2.5 3\n");
  EXPECT_FALSE(WithDecimalPoints("0 0 0\n1 2 3\n"));
}

TEST(DecimalComma, MayBeFollowedByAnExponent) {
  EXPECT_EQ(WithDecimalPoints("1,2E-05 3,5\n0,5 1,25e+2\n"), "1.2E-05 3.5\n0.5 1.25e+2\n");
  EXPECT_TRUE(HasDecimalCommas("1,2E-05 3"));
  EXPECT_FALSE(HasDecimalCommas("1,2E 3"));
  EXPECT_FALSE(HasDecimalCommas("1,2E-0,5 3"));
}

TEST(DecimalComma, IsDistinguishedFromASeparator) {
  EXPECT_FALSE(WithDecimalPoints("1,2,3\n4,5,6\n"));
  EXPECT_FALSE(WithDecimalPoints("12,5\n13,6\n")) << "the comma may separate two columns";
  EXPECT_FALSE(WithDecimalPoints("1.5, 2.5\n"));
  EXPECT_FALSE(WithDecimalPoints("0,5 1\n")) << "one row is no table";
  EXPECT_FALSE(WithDecimalPoints("-1.5 2\n1,5 2,5\n"));
}

}  // namespace
}  // namespace mocurate
