#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <regex>

#include "report/clip_page.h"
#include "report/painters.h"
#include "report/video/clip_video.h"
#include "tests/report/builders.h"

namespace mocurate::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A clip of 40 frames, tracked with 20 mm of noise per axis, with one corrected exchange of sides.
ClipPageInput OneClip() {
  ClipPageInput input;
  const Motion motion = Stepping(Walker(), 40);
  input.clip.item = "test/p1/<a>";
  input.clip.fitted.motion = motion;
  input.clip.fitted.motion->state.assign(40 * 9, JointState::kObserved);
  input.clip.fitted.motion->state[9 * 20 + 3] = JointState::kInterpolated;
  input.clip.fitted.motion->position_cov.assign(40 * 9 * 6, 0.0F);
  for (std::size_t i = 0; i < 40 * 9; ++i) {
    for (const int k : {0, 3, 5}) input.clip.fitted.motion->position_cov[6 * i + k] = 4e-6F;
  }
  input.clip.fitted.fit_rms = 0.0345;
  input.clip.fitted.provenance["track_repairs"] =
      R"([{"code":"swapped_sides","action":"exchanged","frames":[12,15],"joints":["left_knee","left_ankle"],"value":31.5}])";
  input.clip.evidence.evidence.tracks = NoisyTracks(motion);
  Finding finding;
  finding.code = "position_jump";
  finding.frame_begin = 3;
  finding.frame_end = 4;
  finding.message = "2 m <away>";
  input.findings = {finding};
  return input;
}

/// The page without its data and scripts.
std::string WithoutScripts(const std::string& page) { return page.substr(0, page.find("<script")); }

/// Keypoints of the projected joints of a camera, `shift` pixels to the right; a bystander stands 60 px to the left.
KeypointView Detected(const Motion& motion, const Camera& camera, double shift) {
  KeypointView view;
  view.camera = camera;
  view.people = 2;
  for (int f = 0; f < motion.frame_count(); ++f) {
    view.time_s.push_back(motion.rate.FrameTime(f));
    for (const double offset : {-60.0, shift}) {
      for (int j = 0; j < motion.joint_count(); ++j) {
        const Vector2d at = *camera.ProjectWorld(motion.joints.at(f, j)) + Vector2d(offset, 0.0);
        view.values.insert(view.values.end(), {at.x(), at.y(), 1.0});
      }
    }
  }
  return view;
}

TEST(ClipPage, ReportsWhatWasBeforeAndAfterAndWhatWasCorrected) {
  const auto page = MakeClipPage(OneClip());
  ASSERT_TRUE(page) << page.error().Message();
  for (const char* id : {"seen-section", "time", "bones", "repairs", "uncertainty"}) {
    EXPECT_THAT(*page, HasSubstr("<section id=\"" + std::string(id) + "\"")) << id;
  }
  EXPECT_THAT(*page, HasSubstr("34.5 mm"));
  EXPECT_THAT(*page, HasSubstr("<th scope=\"row\">12–14</th><td>swapped_sides (exchanged)</td>"));
  EXPECT_THAT(*page, HasSubstr("left_knee, left_ankle"));
  EXPECT_THAT(*page, HasSubstr("2 m \\u003caway>")) << "in the viewer";
  EXPECT_THAT(*page, HasSubstr("Estimated standard deviation</dt><dd>2.0 mm"));
  EXPECT_THAT(*page, Not(HasSubstr("Over the views"))) << "there are none";
  EXPECT_THAT(*page, Not(HasSubstr("<a>")));
  EXPECT_THAT(WithoutScripts(*page), Not(HasSubstr("nan")));
}

TEST(ClipPage, NeedsNothingButItsVideo) {
  ClipPageInput input = OneClip();
  input.options.video = "clip_001.mp4";
  const auto page = MakeClipPage(input);
  ASSERT_TRUE(page);
  const std::regex address("(src|href)=\"([^\"]*)\"");
  for (std::sregex_iterator it(page->begin(), page->end(), address), end; it != end; ++it) {
    const std::string target = (*it)[2].str().substr(0, 22);
    EXPECT_TRUE(target[0] == '#' || target == "clip_001.mp4" || target == "index.html" || target.rfind("data:", 0) == 0)
        << target;
  }
  EXPECT_EQ(*page, *MakeClipPage(input));
  input.options.video.clear();
  input.options.no_video = "no H.264 encoder";
  EXPECT_THAT(*MakeClipPage(input), HasSubstr("No video: no H.264 encoder"));
}

TEST(ClipPage, AClipOfOneFrameIsShown) {
  ClipPageInput input = OneClip();
  const Motion motion = Stepping(Walker(), 1);
  input.clip.fitted.motion = motion;
  input.clip.evidence.evidence.tracks = NoisyTracks(motion);
  const auto page = MakeClipPage(input);
  ASSERT_TRUE(page) << page.error().Message();
  EXPECT_THAT(WithoutScripts(*page), Not(HasSubstr("nan")));
}

TEST(ClipSeries, ResidualIsThatOfTheNoise) {
  const ClipPageInput input = OneClip();
  const auto series = SeriesOf(input.clip.fitted, input.clip.evidence.evidence);
  ASSERT_TRUE(series);
  double square = 0.0;
  for (const double residual : series->residual) square += residual * residual / 40.0;
  EXPECT_NEAR(std::sqrt(square), 20.0 * std::sqrt(3.0), 4.0);
}

TEST(ClipSeries, KeypointsAreHeldAgainstThePersonNotTheBystander) {
  ClipPageInput input = OneClip();
  Evidence evidence;
  const SkeletonPtr walker = Walker();
  for (const Joint& joint : walker->joints) evidence.keypoint_names.push_back(joint.name);
  evidence.keypoint_views = {Detected(*input.clip.fitted.motion, FrontCamera(), 3.0)};
  const auto series = SeriesOf(input.clip.fitted, evidence);
  ASSERT_TRUE(series);
  EXPECT_THAT(series->residual_name, HasSubstr("px"));
  for (const double residual : series->residual) EXPECT_NEAR(residual, 3.0, 1e-6);
  EXPECT_EQ(FindPerson(evidence.keypoint_views[0], 5,
                       JointsOfKeypoints(*input.clip.fitted.motion->skeleton, evidence.keypoint_names),
                       *input.clip.fitted.motion, 5)
                .index,
            1);
}

TEST(ClipPage, DrawsTheBodyOverKeypointsOfEveryView) {
  ClipPageInput input = OneClip();
  Evidence& evidence = input.clip.evidence.evidence;
  evidence.tracks.reset();
  const SkeletonPtr walker = Walker();
  for (const Joint& joint : walker->joints) evidence.keypoint_names.push_back(joint.name);
  Camera second = FrontCamera();
  second.name = "second";
  evidence.keypoint_views = {Detected(*input.clip.fitted.motion, FrontCamera(), 1.0),
                             Detected(*input.clip.fitted.motion, second, 1.0)};
  const auto page = MakeClipPage(input);
  ASSERT_TRUE(page) << page.error().Message();
  EXPECT_THAT(*page, HasSubstr("Fitted body over view front"));
  EXPECT_THAT(*page, HasSubstr("Fitted body over view second"));
  evidence.keypoint_views.resize(7, evidence.keypoint_views[1]);
  EXPECT_THAT(*MakeClipPage(input), HasSubstr("6 of 7 views."));

  const auto painter = ViewPainter::Make(input.clip.fitted, evidence, 0, {10}, 480, true);
  ASSERT_TRUE(painter) << painter.error().Message();
  const cv::Mat image = *painter->Draw(10);
  EXPECT_EQ(image.rows, 480);
  int yellow = 0;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) yellow += image.at<cv::Vec3b>(y, x) == cv::Vec3b(90, 235, 250) ? 1 : 0;
  }
  EXPECT_GT(yellow, 9 * 15) << "a dot for each of the person's nine keypoints";
}

TEST(ClipVideo, IsH264WithAPictureForEveryFrameAndTheSamePicturesAgain) {
  ScratchFolder folder;
  const ClipPageInput input = OneClip();
  const auto pictures = WriteClipVideo(input.clip, folder / "a");
  ASSERT_TRUE(pictures) << pictures.error().Message();
  EXPECT_EQ(*pictures, 40);
  ASSERT_TRUE(WriteClipVideo(input.clip, folder / "b"));
  cv::VideoCapture first((folder / "a").string(), cv::CAP_FFMPEG);
  cv::VideoCapture again((folder / "b").string(), cv::CAP_FFMPEG);
  cv::Mat one;
  cv::Mat other;
  for (int f = 0; f < 40; ++f) {
    ASSERT_TRUE(first.read(one) && again.read(other)) << f;
    EXPECT_LT(cv::norm(one, other, cv::NORM_L1) / static_cast<double>(one.total() * 3), 2.0) << f;
  }
  cv::VideoCapture video((folder / "a").string(), cv::CAP_FFMPEG);
  ASSERT_TRUE(video.isOpened());
  EXPECT_EQ(static_cast<int>(video.get(cv::CAP_PROP_FRAME_COUNT)), 40);
  EXPECT_EQ(static_cast<int>(video.get(cv::CAP_PROP_FRAME_HEIGHT)), 480);
  EXPECT_NEAR(video.get(cv::CAP_PROP_FPS), 30.0, 1e-3);
  const auto code = static_cast<int>(video.get(cv::CAP_PROP_FOURCC));
  const std::string name = {static_cast<char>(code), static_cast<char>(code >> 8), static_cast<char>(code >> 16),
                            static_cast<char>(code >> 24)};
  EXPECT_THAT(name, testing::AnyOf("avc1", "h264", "H264"));
  EXPECT_EQ(*WriteClipVideo(input.clip, folder / "c", 10), 10);
}

TEST(ClipVideo, OfAFastCameraPlaysAtTheSpeedOfTheClip) {
  ScratchFolder folder;
  ClipPageInput input = OneClip();
  input.clip.fitted.motion->rate = FrameRate{240, 1};
  const auto pictures = WriteClipVideo(input.clip, folder / "fast");
  ASSERT_TRUE(pictures) << pictures.error().Message();
  EXPECT_EQ(*pictures, 10);
  const cv::VideoCapture video((folder / "fast").string(), cv::CAP_FFMPEG);
  ASSERT_TRUE(video.isOpened());
  EXPECT_NEAR(video.get(cv::CAP_PROP_FPS), 60.0, 1e-3);
  EXPECT_FALSE(std::filesystem::exists(folder / "fast.mp4"));
}

}  // namespace
}  // namespace mocurate::test
