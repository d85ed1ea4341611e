#include "core/base/error.h"

#include <gtest/gtest.h>

#include "core/base/problem_list.h"

namespace mocurate {
namespace {

TEST(Error, ReportsPlaceFactAndWayOutOnOneLine) {
  EXPECT_EQ((Error{ErrorCode::kMalformed, "12 columns", "a.trc:8", "check it"}.Message()),
            "a.trc:8: 12 columns (check it)");
  EXPECT_EQ((Error{ErrorCode::kMalformed, "12 columns", "", ""}.Message()), "12 columns");
}

TEST(Error, EveryCodeHasANameThatLeadsBackToIt) {
  for (int i = 0; i <= static_cast<int>(ErrorCode::kInternal); ++i) {
    const auto code = static_cast<ErrorCode>(i);
    EXPECT_EQ(ErrorCodeFromName(Name(code)), code);
  }
  EXPECT_EQ(ErrorCodeFromName("nonsense"), ErrorCode::kInternal);
}

TEST(Error, ExitCodesAreTheDocumentedOnes) {
  EXPECT_EQ(static_cast<int>(ExitCodeOf(ErrorCode::kConfig)), 2);
  EXPECT_EQ(static_cast<int>(ExitCodeOf(ErrorCode::kMalformed)), 3);
  EXPECT_EQ(static_cast<int>(ExitCodeOf(ErrorCode::kMissingOnHost)), 4);
  EXPECT_EQ(static_cast<int>(ExitCodeOf(ErrorCode::kInternal)), 70);
  EXPECT_EQ(static_cast<int>(ExitCodeOf(ErrorCode::kCannotWrite)), 74);
  EXPECT_EQ(static_cast<int>(ExitCodeOf(ErrorCode::kInterrupted)), 75);
  EXPECT_EQ(static_cast<int>(ExitCodeOf(ErrorCode::kTooManyFailures)), 1);
}

TEST(ProblemList, ReportsOneProblemAsItIsAndManyLineByLine) {
  ProblemList problems;
  EXPECT_TRUE(problems.Result());
  problems.Add("a:1:2", "wrong", "correct it");
  EXPECT_EQ(problems.Result().error(), (Error{ErrorCode::kConfig, "wrong", "a:1:2", "correct it"}));
  problems.Add("a:3:4", "also wrong");
  EXPECT_EQ(problems.Result().error().Message(), "a:1:2: wrong (correct it)\na:3:4: also wrong");
}

TEST(ProblemList, StopsAfterFiftyLines) {
  ProblemList problems;
  for (int i = 0; i < 60; ++i) problems.Add("", "p");
  EXPECT_NE(problems.Result().error().what.find("\nand 10 more"), std::string::npos);
}

TEST(ProblemList, AsksForTheHintsOfTheLinesThatItShows) {
  ProblemList problems;
  int asked = 0;
  for (int i = 0; i < 60; ++i) problems.Add("", "p", [&asked] { return "hint " + std::to_string(++asked); });
  EXPECT_EQ(asked, 50);
  EXPECT_NE(problems.Result().error().what.find("(hint 50)"), std::string::npos);
}

}  // namespace
}  // namespace mocurate
