#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/report/builders.h"

namespace mocurate::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kChromium = "/usr/bin/chromium";

/// Opens the page in a browser that may load nothing; its document and its log come back as files in the folder.
int Browse(const SmallRun& run, const std::string& what) {
  const std::string folder = run.folder / "";
  const std::string command =
      "timeout 120 " + std::string(kChromium) +
      " --headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking"
      " --disable-component-update --disable-sync --enable-logging=stderr --user-data-dir='" +
      folder + "profile' " + what + " --window-size=1200,2000 'file://" + folder + "index.html' > '" + folder +
      "dom.html' 2> '" + folder + "log.txt'";
  return std::system(command.c_str());
}

TEST(ReportInABrowser, PlayersStandAndThePageIsNotBlank) {
  if (!std::filesystem::exists(kChromium)) {
    if (std::getenv("MOCURATE_DATA") != nullptr) FAIL() << kChromium << " is missing: install chromium";
    GTEST_SKIP() << kChromium << " is missing";
  }
  SmallRun run;
  ASSERT_TRUE(run.Page());
  ASSERT_EQ(Browse(run, "--virtual-time-budget=2000 --dump-dom"), 0) << ReadFile(run.folder / "log.txt").value_or("");
  const std::string document = ReadFile(run.folder / "dom.html").value_or("");
  EXPECT_THAT(document, HasSubstr("data-ready=\"3\"")) << "the script has built all players";
  EXPECT_THAT(document, HasSubstr("max=\"39\"")) << "the slider spans the frames of the clip";
  EXPECT_THAT(ReadFile(run.folder / "log.txt").value_or(""), Not(HasSubstr("CONSOLE")));

  ASSERT_EQ(Browse(run, "--screenshot='" + (run.folder / "page.png").string() + "'"), 0);
  const std::string picture = ReadFile(run.folder / "page.png").value_or("");
  ASSERT_THAT(picture, HasSubstr("PNG"));
  EXPECT_GT(picture.size(), 60000U) << "a blank picture of this size takes about 10 kB";
}

}  // namespace
}  // namespace mocurate::test
