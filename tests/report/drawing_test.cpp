#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/body/capsule_body.h"
#include "report/charts.h"
#include "report/filmstrip.h"
#include "report/html.h"
#include "report/motion_rows.h"
#include "report/painters.h"
#include "report/posed_body.h"
#include "tests/report/builders.h"

namespace mocurate::test {
namespace {

TEST(Html, ControlCharactersAndBrokenUtf8BecomeReplacementCharacters) {
  EXPECT_EQ(EscapeHtml("a<b>&\"'"), "a&lt;b&gt;&amp;&quot;&#39;");
  EXPECT_EQ(EscapeHtml(std::string("x\x01y\xFFz")), "x\xEF\xBF\xBDy\xEF\xBF\xBDz");
}

TEST(Html, JsonInAScriptCannotEndIt) {
  EXPECT_EQ(JsonForScript(nlohmann::json("</script><!--")), "\"\\u003c/script>\\u003c!--\"");
}

TEST(Html, NumbersAreShort) {
  EXPECT_EQ(FixedText(-0.04, 1), "0.0");
  EXPECT_EQ(FixedText(12.345, 2), "12.35");
  EXPECT_EQ(ShortText(1234.4), "1234");
  EXPECT_EQ(ShortText(1e-9), "&lt; 0.001");
  EXPECT_EQ(CountText(1234567), "1\u2009234\u2009567");
}

TEST(Charts, AxisMarksAreRoundAndCoverTheRange) {
  EXPECT_EQ(AxisMarks(0.0, 10.0, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  for (const double high : {1e-6, 0.37, 1.0, 9.99, 123.0, 4.2e7}) {
    for (const int most : {3, 5, 7}) {
      const std::vector<double> marks = AxisMarks(0.0, high, most);
      ASSERT_GE(marks.size(), 2U) << high;
      EXPECT_LE(marks.size(), static_cast<std::size_t>(most) + 1) << high;
      EXPECT_LE(marks.back(), high * (1 + 1e-9));
    }
  }
  EXPECT_TRUE(AxisMarks(1.0, 1.0, 5).empty());
}

TEST(Charts, CurvesWithoutAFiniteNumberDrawNothing) {
  EXPECT_EQ(PlotHtml({"t", "x", "y", {{"c", {{1.0, std::nan("")}}}}}), "");
}

TEST(Viewpoint, APersonThatFacesAnywhereIsSeenFromTheFront) {
  const SkeletonPtr skeleton = Walker();
  for (const double facing : {0.0, 1.0, 2.5, -2.0}) {
    Motion motion = Stepping(skeleton, 3);
    for (int f = 0; f < 3; ++f) motion.rotation_at(f, 0) = ExpQuaternion(Vector3d(0.0, facing, 0.0));
    ComputeJoints(motion);
    const Viewpoint view = FrontView(motion);
    const Vector3d forward = view.Turn(ExpQuaternion(Vector3d(0.0, facing, 0.0)) * Vector3d::UnitZ());
    const Vector3d left = view.Turn(motion.joints.at(1, 1) - motion.joints.at(1, 2));
    EXPECT_GT(forward.z(), 0.8) << "the chest points to the eye";
    EXPECT_GT(left.x(), 0.0) << "the person's left is on the right of the picture";
  }
}

TEST(Filmstrip, StillsSpanTheWholeClip) {
  EXPECT_EQ(StillFrames(9, 5), (std::vector<int>{0, 2, 4, 6, 8}));
  EXPECT_EQ(StillFrames(2, 8), (std::vector<int>{0, 1}));
  EXPECT_TRUE(StillFrames(0, 8).empty());
}

TEST(Filmstrip, PointsOfJointsWithoutTheirParentHangOnTheNearestObservedAncestor) {
  const SkeletonPtr skeleton = Walker();
  JointTracks tracks;
  tracks.names = {"left_hip", "left_ankle", "head", "a sensor of its own"};
  const TrackDrawing drawing = MatchTracks(tracks.names, *skeleton);
  ASSERT_EQ(drawing.lines.size(), 1U);
  EXPECT_EQ(drawing.lines[0], (std::array<int, 2>{0, 1}));
}

TEST(Pictures, Base64FollowsTheStandardsExamples) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
}

class PictureTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto evidence = ReadEvidence(run_.folder / "evidence_c.h5");
    auto fit = ReadDataset(run_.folder / "fit_c.h5");
    ASSERT_TRUE(evidence && fit);
    evidence_ = evidence->evidence;
    fitted_ = fit->clips.front();
    ResolveDepthFiles({{"depth/c.png", run_.folder / "depth.png"}}, evidence_);
  }

  SmallRun run_;
  Evidence evidence_;
  Clip fitted_;
};

TEST_F(PictureTest, AViewUnderTheBodyIsWrittenAsPng) {
  const auto png = BodyOverlayPng(fitted_, evidence_, 0, 20);
  ASSERT_TRUE(png) << png.error().Message();
  EXPECT_EQ(png->substr(1, 3), "PNG");
}

TEST_F(PictureTest, ABodyIsDrawnWithTheRadiiItWasFittedWith) {
  const PosedBody plain = BodyOf(fitted_, 20);
  const std::size_t count = CapsuleBody::Make(fitted_.motion->skeleton, 1.0).capsules.size();
  ASSERT_GT(count, 0u);
  std::string radii = "0.2";
  for (std::size_t i = 1; i < count; ++i) radii += " 0.2";
  fitted_.provenance[kCapsuleRadii] = radii;
  const PosedBody body = BodyOf(fitted_, 20);
  ASSERT_EQ(body.capsules.capsules.size(), count);
  ASSERT_EQ(body.sides.size(), count);
  for (const Capsule& capsule : body.capsules.capsules) {
    EXPECT_DOUBLE_EQ(capsule.radius, 0.2);
    ASSERT_LT(capsule.joint, static_cast<int>(body.points.size()));
  }
  for (const Capsule& capsule : plain.capsules.capsules) EXPECT_LT(capsule.radius, 0.19);

  fitted_.provenance[kCapsuleRadii] = "0.2";  // of another skeleton
  EXPECT_EQ(BodyOf(fitted_, 20).capsules.capsules.size(), plain.capsules.capsules.size());
}

TEST_F(PictureTest, WhatIsNotThereIsNamed) {
  EXPECT_EQ(BodyOverlayPng(fitted_, evidence_, 3, 20).error().code, ErrorCode::kInconsistent);
  EXPECT_EQ(BodyOverlayPng(fitted_, evidence_, 0, 400).error().code, ErrorCode::kInconsistent);
  evidence_.depth_views[0].camera.width = 100;
  EXPECT_EQ(BodyOverlayPng(fitted_, evidence_, 0, 20).error().code, ErrorCode::kInconsistent);
  ASSERT_TRUE(WriteFile(run_.folder / "depth.png", "no picture"));
  EXPECT_EQ(BodyOverlayPng(fitted_, evidence_, 0, 20).error().code, ErrorCode::kMalformed);
}

}  // namespace
}  // namespace mocurate::test
