#include "report/video/clip_video.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <utility>

#include "core/base/text.h"
#include "report/motion_rows.h"
#include "report/painters.h"
#include "report/stages.h"

namespace mocurate {
namespace {

constexpr const char* kHowToEncode =
    "OpenCV's videoio writes with FFmpeg's libavcodec, which needs libx264 (Debian: libopencv-videoio406, "
    "libavcodec59, "
    "libx264-164)";

int PicturesIn(const std::filesystem::path& file) {
  try {
    const cv::VideoCapture video(file.string(), cv::CAP_FFMPEG);
    return video.isOpened() ? static_cast<int>(std::lround(video.get(cv::CAP_PROP_FRAME_COUNT))) : 0;
  } catch (const cv::Exception&) {
    return 0;
  }
}

/// A file under a temporary name; removed unless it is completed.
class PartialFile {
 public:
  explicit PartialFile(std::filesystem::path path) : path_(std::move(path)) {}
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  ~PartialFile() {
    std::error_code unknown;
    std::filesystem::remove(path_, unknown);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

constexpr double kMostPerSecond = 60.0;
constexpr double kMostOfRows = 30.0;  // pictures a second of motions side by side
constexpr double kRateSlack = 1e-9;
constexpr int kHeight = 480;   // pixels, even as H.264 needs it
constexpr int kMostViews = 3;  // beside the front

/// Decimation step: at most `most` frames in all, and at most the players' maximum rate.
int StepOf(const Motion& motion, int most) {
  const int frames = motion.frame_count();
  const double slowed = std::ceil(motion.rate.hz() / kMostPerSecond - kRateSlack);
  return std::max({1, (frames + most - 1) / most, static_cast<int>(std::min<double>(slowed, frames))});
}

void WriteName(const std::string& name, cv::Mat& image) {
  cv::putText(image, name, {8, 18}, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar(235, 235, 235), 1, cv::LINE_AA);
}

/// H.264 needs even sides.
cv::Mat Even(const cv::Mat& image) {
  cv::Mat even;
  cv::copyMakeBorder(image(cv::Rect(0, 0, image.cols, std::min(image.rows, kHeight))), even, 0,
                     std::max(0, kHeight - image.rows), 0, image.cols % 2, cv::BORDER_REPLICATE);
  return even;
}

struct Panels {
  FrontPainter front;
  std::vector<ViewPainter> views;
  std::vector<std::string> names;

  Expected<cv::Mat> Draw(int frame) const {
    std::vector<cv::Mat> images = {Even(front.Draw(frame))};
    for (std::size_t i = 0; i < views.size(); ++i) {
      auto image = views[i].Draw(frame);
      if (!image) return image;
      WriteName(names[i], *image);
      images.push_back(Even(*image));
    }
    cv::Mat joined;
    cv::hconcat(images, joined);
    return joined;
  }
};

/// Draws pictures 0 to `count` - 1 of one size with even sides and writes them atomically as H.264 (MP4). Returns their
/// number. Errors of drawing; kMissingOnHost where OpenCV finds no encoder, kCannotWrite; both name `item`.
Expected<int> WriteVideo(const std::string& item, double rate_hz, int count,
                         const std::function<Expected<cv::Mat>(int)>& draw, const std::filesystem::path& file) {
  const PartialFile partial(file.string() + ".mp4");  // OpenCV chooses the container by the name
  cv::VideoWriter writer;
  for (int picture = 0; picture < count; ++picture) {
    const auto image = draw(picture);
    if (!image) return Forward(image);
    if (picture == 0) {
      try {
        writer.open(partial.path().string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('a', 'v', 'c', '1'), rate_hz,
                    image->size());
      } catch (const cv::Exception&) {
        // Reported below.
      }
      if (!writer.isOpened()) {
        return Fail(ErrorCode::kMissingOnHost, "no H.264 encoder: a video cannot be written", item, kHowToEncode);
      }
    }
    writer.write(*image);
  }
  writer.release();
  if (PicturesIn(partial.path()) != count) {
    return Fail(ErrorCode::kCannotWrite, "the video is incomplete", item, "check the disk space");
  }
  std::error_code problem;
  std::filesystem::rename(partial.path(), file, problem);
  if (problem) return Fail(ErrorCode::kCannotWrite, "the video cannot be written: " + problem.message(), item);
  return count;
}

}  // namespace

Expected<int> WriteClipVideo(const DrawnClip& clip, const std::filesystem::path& file, int most_pictures) {
  if (Status ok = CheckFrame(clip.fitted, 0); !ok) return Forward(ok);
  const Motion& motion = *clip.fitted.motion;
  const Evidence& evidence = clip.evidence.evidence;
  const int frames = motion.frame_count();
  const int step = StepOf(motion, most_pictures);
  std::vector<int> shown;
  for (int f = 0; f < frames; f += step) shown.push_back(f);
  Panels panels{FrontPainter(clip.fitted, evidence, kHeight), {}, {}};
  for (const int view : ChosenViews(evidence, kMostViews)) {
    auto painter = ViewPainter::Make(clip.fitted, evidence, view, shown, kHeight, true);
    if (!painter) return Forward(painter);
    panels.views.push_back(std::move(*painter));
    panels.names.push_back(ViewCamera(evidence, view).name);
  }
  return WriteVideo(
      clip.item, motion.rate.hz() / step, static_cast<int>(shown.size()),
      [&](int picture) { return panels.Draw(shown[static_cast<std::size_t>(picture)]); }, file);
}

Expected<StageOutcome> ClipVideoStage(const StageRequest& request) {
  const auto drawn = ReadDrawnClip(request);
  if (!drawn) return Forward(drawn);
  const auto pictures = WriteClipVideo(*drawn, request.output);
  if (!pictures) return Forward(pictures);
  StageOutcome outcome;
  outcome.summary = {{"pictures", *pictures}};
  return outcome;
}

Expected<StageOutcome> MotionVideoStage(const StageRequest& request) {
  const auto options = OptionsFromJson<MotionPictureOptions>(request.options, "draw");
  if (!options) return Forward(options);
  const auto rows = ReadRows(request, *options);
  if (!rows) return Forward(rows);
  double rate = 1.0, frames = 1.0, seconds = 0.0;
  for (const MotionRow& row : *rows) {
    if (row.clips.empty()) continue;
    rate = std::min(kMostOfRows, std::max(rate, row.clips.front().motion->rate.hz()));
    frames = std::max(frames, static_cast<double>(row.clips.front().motion->frame_count()));
    seconds = std::max(seconds, row.clips.front().motion->duration());
  }
  const double pictures_of_all = std::round(seconds * rate);
  if (pictures_of_all > kMostOfRows * frames) {  // slower than a frame a second
    return Fail(ErrorCode::kUnsupported,
                "the video has " + FormatDouble(pictures_of_all) + " pictures of motions of at most " +
                    FormatDouble(frames) + " frames",
                request.item, "correct the rates of the motions, or draw those of one rate");
  }
  const int count = std::max(1, static_cast<int>(pictures_of_all));
  const auto draw = [&](int picture) -> Expected<cv::Mat> {
    const cv::Mat image = ToImage(DrawMotionGrid(*rows, *options, picture / rate), options->scale);
    return image(cv::Rect(0, 0, image.cols / 2 * 2, image.rows / 2 * 2)).clone();
  };
  const auto pictures = WriteVideo(request.item, rate, count, draw, request.output);
  if (!pictures) return Forward(pictures);
  StageOutcome outcome;
  outcome.summary = {{"rows", rows->size()}, {"pictures", *pictures}, {"shown", DescribeRows(*rows, *options)}};
  return outcome;
}

}  // namespace mocurate
