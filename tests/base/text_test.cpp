#include "core/base/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>

#include "core/base/random.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

void ExpectNumbersReadAndWritten() {
  EXPECT_EQ(ParseDouble("1.5"), 1.5);
  EXPECT_EQ(ParseDouble("+1.5e3"), 1500.0);
  EXPECT_EQ(ParseDouble("-.25"), -0.25);
  EXPECT_EQ(ParseInteger("+42"), 42);
  EXPECT_EQ(FormatDouble(0.1), "0.1");
  EXPECT_EQ(FormatDouble(30.0), "30");
  EXPECT_EQ(FormatDouble(1e-6), "1e-06");
  EXPECT_EQ(FormatDouble(100000.0), "100000");
}

TEST(Text, NumbersForPeopleAreRoundedToTheirSignificantDigits) {
  EXPECT_EQ(RoundedText(0.1 + 0.2), "0.3");
  EXPECT_EQ(RoundedText(120000.0 / 1001.0), "119.9");
  EXPECT_EQ(RoundedText(-1234567.0), "-1235000");
  EXPECT_EQ(RoundedText(0.0), "0");
  EXPECT_EQ(RoundedText(2.0 / 3.0, 2), "0.67");
}

TEST(Text, CountsAgreeWithTheirNouns) {
  EXPECT_EQ(Counted(1, "clip"), "1 clip");
  EXPECT_EQ(Counted(0, "clip"), "0 clips");
  EXPECT_EQ(Counted(12, "clip"), "12 clips");
}

TEST(Text, ReadsAndWritesNumbers) { ExpectNumbersReadAndWritten(); }

TEST(Text, NumbersDoNotDependOnTheLocale) {
  const std::string kept = std::setlocale(LC_ALL, nullptr);
  const char* comma = nullptr;
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "de_DE", "fr_FR.UTF-8", "fr_FR"}) {
    if (comma == nullptr) comma = std::setlocale(LC_ALL, name);
  }
  if (comma == nullptr) {
    // The source of a locale is part of glibc's programs: build one where none is installed.
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / "mocurate_locale_test";
    std::filesystem::create_directories(folder);
    const std::string command =
        "localedef -i de_DE -f UTF-8 '" + (folder / "de_DE.UTF-8").native() + "' >/dev/null 2>&1";
    if (std::system(command.c_str()) == 0) {
      ::setenv("LOCPATH", folder.c_str(), 1);
      comma = std::setlocale(LC_ALL, "de_DE.UTF-8");
      ::unsetenv("LOCPATH");
    }
  }
  if (comma == nullptr) GTEST_SKIP() << "no locale with a decimal comma on this machine";
  EXPECT_EQ(std::strtod("1,5", nullptr), 1.5) << "the locale is in force";
  ExpectNumbersReadAndWritten();
  std::setlocale(LC_ALL, kept.c_str());
}

TEST(Text, RefusesTextAroundANumber) {
  for (const char* text : {"", " 1", "1 ", "1,5", "1.5x", "0x10", "--1", "+-1", "+", "1e", "1e999", "."}) {
    EXPECT_FALSE(ParseDouble(text)) << "'" << text << "'";
  }
  for (const char* text : {"", "1.0", "1e3", "9223372036854775808", "+-1", "a"}) {
    EXPECT_FALSE(ParseInteger(text)) << "'" << text << "'";
  }
}

TEST(Text, TinyNumbersAreZeroAndNonFiniteOnesAreNumbers) {
  EXPECT_EQ(ParseDouble("1e-999"), 0.0);
  EXPECT_TRUE(std::isnan(ParseDouble("nan").value()));
  EXPECT_TRUE(std::isinf(ParseDouble("-inf").value()));
}

TEST(Text, EveryDoubleReadsBackAsItself) {
  Random random(1, "doubles");
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t bits = (std::uint64_t{random.Next()} << 32) | random.Next();
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof(value));
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(ParseDouble(FormatDouble(value)), value) << FormatDouble(value);
  }
  EXPECT_EQ(FormatDouble(std::numeric_limits<double>::denorm_min()), "5e-324");
}

TEST(Text, SplitsAndTrims) {
  EXPECT_EQ(Trim(" \t a b\r\n"), "a b");
  EXPECT_EQ(Trim("  "), "");
  EXPECT_THAT(SplitText("a,,b", ','), ElementsAre("a", "", "b"));
  EXPECT_THAT(SplitText("", ','), ElementsAre(""));
  EXPECT_THAT(SplitBlanks("  1 \t 2\r\n"), ElementsAre("1", "2"));
  EXPECT_THAT(SplitBlanks(" "), ElementsAre());
}

TEST(Text, FindsTheWordThatWasMeant) {
  const std::vector<std::string> known = {"still_speed", "enabled", "rate"};
  EXPECT_EQ(Nearest("still_sped", known), "still_speed");
  EXPECT_EQ(Nearest("still-speed", known), "still_speed");
  EXPECT_EQ(Nearest("Rate", known), "rate");
  EXPECT_EQ(Nearest("raet", known), "rate");
  EXPECT_EQ(Nearest("frequency", known), std::nullopt);
  EXPECT_EQ(Nearest("", known), std::nullopt);
  EXPECT_EQ(Nearest("P1", {"P10", "P01", "P11"}), "P01");
  EXPECT_EQ(Nearest("s007", {"s07", "s70"}), "s07");
  EXPECT_EQ(Nearest("p0", {"p00", "p01"}), "p00");
  EXPECT_EQ(Nearest("P3", {"P01", "P02"}), std::nullopt);
}

}  // namespace
}  // namespace mocurate
