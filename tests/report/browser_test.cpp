#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/browser.h"
#include "tests/report/builders.h"

namespace mocurate::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ReportInABrowser, TablesSortAndThePageIsNotBlank) {
  if (!HasBrowser()) GTEST_SKIP() << "chromium is missing";
  SmallRun run;
  ASSERT_TRUE(run.Page());
  ASSERT_EQ(Browse(run.folder, "--virtual-time-budget=2000 --dump-dom"), 0)
      << ReadFile(run.folder / "log.txt").value_or("");
  const std::string document = ReadFile(run.folder / "dom.html").value_or("");
  EXPECT_THAT(document, HasSubstr("class=\"sort\"")) << "the script has worked on the tables";
  EXPECT_THAT(ReadFile(run.folder / "log.txt").value_or(""), Not(HasSubstr("CONSOLE")));

  ASSERT_EQ(Browse(run.folder, "--screenshot='" + (run.folder / "page.png").string() + "'"), 0);
  const std::string picture = ReadFile(run.folder / "page.png").value_or("");
  ASSERT_THAT(picture, HasSubstr("PNG"));
  EXPECT_GT(picture.size(), 60000U) << "a blank picture of this size takes about 10 kB";
}

}  // namespace
}  // namespace mocurate::test
