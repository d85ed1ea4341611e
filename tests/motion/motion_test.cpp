#include <gmock/gmock.h>

#include "tests/motion/builders.h"

namespace mocurate {
namespace {

using test::Built;
using test::SwingingPerson;
using testing::HasSubstr;

TEST(FrameRate, ReadsWholeBrokenAndFractionalRates) {
  EXPECT_EQ(FrameRate::Parse("30").value(), (FrameRate{30, 1}));
  EXPECT_EQ(FrameRate::Parse("120000/1001").value(), (FrameRate{120000, 1001}));
  EXPECT_EQ(FrameRate::Parse("29.97").value(), (FrameRate{30000, 1001}));
  EXPECT_EQ(FrameRate::Parse(" 60/2 ").value(), (FrameRate{30, 1}));
  EXPECT_EQ(FrameRate::Parse("1/1000").value(), (FrameRate{1, 1000}));
  EXPECT_EQ(FrameRate::Parse("100 kHz").value(), (FrameRate{100000, 1}));
  for (const char* bad : {"", "fast", "0", "-30", "30/0", "30/1/1", "nan", "inf", "1/5000", "1/1000000000000000000",
                          "0.0001", "100001", "101 kHz"}) {
    const auto rate = FrameRate::Parse(bad);
    ASSERT_FALSE(rate) << bad;
    EXPECT_EQ(rate.error().code, ErrorCode::kMalformed);
  }
}

TEST(FrameRate, FrameTimesOfBvhFilesAreRecognised) {
  EXPECT_EQ(FrameRate::FromHz(1.0 / 0.0333333), (FrameRate{30, 1}));
  EXPECT_EQ(FrameRate::FromHz(1.0 / 0.00833333), (FrameRate{120, 1}));
  EXPECT_EQ(FrameRate::FromHz(59.94), (FrameRate{60000, 1001}));
  EXPECT_EQ(FrameRate::FromHz(12.5), (FrameRate{25, 2}));
  EXPECT_EQ((FrameRate{120000, 1001}.Text()), "120000/1001");
  EXPECT_EQ((FrameRate{25, 1}.Text()), "25");
}

TEST(ClipIdentity, IsSourcePersonRecordingAndSpan) {
  ClipIdentity identity;
  identity.source = "kard";
  identity.person = "s01";
  identity.recording = "a01_e02";
  identity.end_frame = 97;
  EXPECT_EQ(identity.id(), "kard/s01/a01_e02#0-97");
}

void ExpectBrokenMotion(const Motion& motion, const std::string& words) {
  const Status check = motion.Check();
  ASSERT_FALSE(check) << "expected: " << words;
  EXPECT_THAT(check.error().Message(), HasSubstr(words));
}

TEST(MotionCheck, FindsEachBrokenRule) {
  const Motion good = SwingingPerson(Built("openni16"), 4);
  ASSERT_TRUE(good.Check()) << good.Check().error().Message();
  Motion m = good;
  m.rotation.pop_back();
  ExpectBrokenMotion(m, "rotation has 63 entries, 64 are needed");
  m = good;
  m.joints.at(2, 3).x() += 1e-3;
  ExpectBrokenMotion(m, "'head' of frame 2");
  m = good;
  m.rotation_at(1, 2).coeffs() *= 1.01;
  ExpectBrokenMotion(m, "frame 1, joint 'neck'");
  m = good;
  m.joints.xyz[5] = std::nan("");
  ExpectBrokenMotion(m, "joints is not finite at index 5");
  m = good;
  m.contact.pop_back();
  ExpectBrokenMotion(m, "contact has 7");
  m = good;
  m.skeleton = Built("openni15");
  ExpectBrokenMotion(m, "16 joints");
  EXPECT_TRUE(MakeJointsOnly(good.skeleton, good.rate, good.joints).Check());
}

}  // namespace
}  // namespace mocurate
