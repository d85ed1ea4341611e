// Stray lines between the frames of an AMC file.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/formats/amc.h"

namespace mocurate {
namespace {

using ::testing::ElementsAre;

Expected<Amc> ReadStray(const std::string& frames) {
  return ParseAmc(":DEGREES\n" + frames, {nullptr, DamagedRows::kReport}, "wave.amc");
}

const char* const kTwo = "1\nroot 1 2\narm 3\n2\nroot 4 5\narm 6\n";

TEST(AmcStrayLines, AWordBeforeAFrameNumberStartsNoFrame) {
  const auto amc = ReadStray(std::string(kTwo) + "pause\n3\nroot 7 8\narm 9\n4\nroot 1 2\narm 3\n");
  ASSERT_TRUE(amc) << amc.error().Message();
  EXPECT_THAT(amc->frame_numbers, ElementsAre(1, 2, 3, 4));
  EXPECT_TRUE(amc->damaged.empty());
  ASSERT_EQ(amc->findings.size(), 1u);
  EXPECT_EQ(amc->findings[0].code, "frame_number");
  EXPECT_EQ(amc->findings[0].frame_begin, 2);
  EXPECT_EQ(amc->findings[0].value, 3.0);
}

TEST(AmcStrayLines, AWordInPlaceOfTheFrameNumberStartsTheFrame) {
  const auto amc = ReadStray(std::string(kTwo) + "3x\nroot 7 8\narm 9\n4\nroot 1 2\narm 3\n");
  ASSERT_TRUE(amc) << amc.error().Message();
  EXPECT_THAT(amc->frame_numbers, ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(amc->findings.size(), 1u);
}

TEST(AmcStrayLines, ARepeatedFrameNumberStartsTwoFrames) {
  const auto amc = ReadStray(std::string(kTwo) + "3\n3\nroot 7 8\narm 9\n");
  ASSERT_TRUE(amc) << amc.error().Message();
  EXPECT_THAT(amc->frame_numbers, ElementsAre(1, 2, 3, 3));
}

}  // namespace
}  // namespace mocurate
