#include "core/formats/number_scanner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>

#include "core/base/random.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;
using Token = NumberScanner::Token;

/// A decimal of up to 21 digits, with optional sign, point and exponent.
std::string Decimal(Random& random) {
  std::string text = random.Below(2) == 0 ? "-" : "";
  const std::uint64_t whole = random.Below(12), fraction = random.Below(10);
  for (std::uint64_t i = 0; i < whole; ++i) text += static_cast<char>('0' + random.Below(10));
  if (fraction > 0 || whole == 0) text += '.';
  for (std::uint64_t i = 0; i < fraction + (whole == 0 ? 1 : 0); ++i) text += static_cast<char>('0' + random.Below(10));
  if (random.Below(3) == 0) {
    text += random.Below(2) == 0 ? "e" : "E";
    if (const std::uint64_t sign = random.Below(3); sign > 0) text += sign == 1 ? "-" : "+";
    text += std::to_string(random.Below(random.Below(2) == 0 ? 10 : 60));
  }
  return text;
}

TEST(NumberScanner, ReadsEveryDecimalAsTheNearestDouble) {
  Random random(3, "decimals");
  for (int i = 0; i < 50000; ++i) {
    const std::string text = Decimal(random);
    const double expected = std::strtod(text.c_str(), nullptr);
    for (const std::string& bytes : {text, text + " ", text + "\n1 2 3 4"}) {
      NumberScanner scanner(bytes, false);
      ASSERT_EQ(scanner.Next(), Token::kNumber) << bytes;
      const double value = scanner.value();
      ASSERT_EQ(std::memcmp(&value, &expected, sizeof(value)), 0) << bytes << " is " << value << ", not " << expected;
      ASSERT_EQ(scanner.text(), text);
      std::vector<double> values;
      NumberScanner(bytes, false).Numbers(values);
      ASSERT_EQ(std::memcmp(&values.at(0), &expected, sizeof(expected)), 0) << bytes;
    }
  }
}

TEST(NumberScanner, EndsARowAtTheFirstNonNumber) {
  std::vector<double> values;
  NumberScanner scanner("1 2.5 -3e2\r\n4 five 6\nnan", false, 7);
  EXPECT_EQ(scanner.Numbers(values), Token::kLineEnd);
  EXPECT_EQ(scanner.line(), 8);
  EXPECT_EQ(scanner.Numbers(values), Token::kWord);
  EXPECT_EQ(scanner.text(), "five");
  EXPECT_EQ(scanner.Numbers(values), Token::kLineEnd);
  EXPECT_EQ(scanner.Numbers(values), Token::kNotFinite);
  EXPECT_EQ(scanner.Numbers(values), Token::kEnd);
  EXPECT_THAT(values, ElementsAre(1, 2.5, -300, 4, 6));
}

TEST(NumberScanner, ReadsATokenThatOnlyStartsAsANumberAsAWord) {
  for (const char* text :
       {"1x", "1e", "1e+", "1.2.3", "--1", "-", ".", "1:2", "12345678a", "123456789\xB0", "0x10", "1,2"}) {
    NumberScanner scanner(text, false);
    EXPECT_EQ(scanner.Next(), Token::kWord) << text;
    EXPECT_EQ(scanner.text(), text);
    EXPECT_EQ(scanner.Next(), Token::kEnd);
  }
}

}  // namespace
}  // namespace mocurate
