#include "core/base/log.h"

#include <gtest/gtest.h>

namespace mocurate {
namespace {

TEST(Log, LinesGoToStderrWithTheirLevelAndNothingToStdout) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  LogInfo("read {} of %s clips");
  LogWarning("one is suspect");
  Log(LogLevel::kDebug, "not shown");
  SetLogLevel(LogLevel::kError);
  LogWarning("not shown");
  Log(LogLevel::kError, "failed");
  SetLogLevel(LogLevel::kInfo);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "info: read {} of %s clips\nwarning: one is suspect\nerror: failed\n");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace mocurate
