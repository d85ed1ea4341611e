#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "report/drawing_image.h"
#include "report/filmstrip.h"
#include "report/motion_picture_stage.h"
#include "report/stages.h"
#include "report/video/clip_video.h"

namespace mocurate {

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
  constexpr double kMostPerSecond = 30.0;
  double rate = 1.0, frames = 1.0;
  for (const MotionRow& row : *rows) {
    rate = std::min(kMostPerSecond, std::max(rate, row.clip.motion->rate.hz()));
    frames = std::max(frames, static_cast<double>(row.clip.motion->frame_count()));
  }
  const MotionGrid grid(*rows, *options);
  const double pictures_of_all = std::round(grid.seconds() * rate);
  if (pictures_of_all > kMostPerSecond * frames) {  // slower than a frame a second
    return Fail(ErrorCode::kUnsupported,
                "the video has " + FormatDouble(pictures_of_all) + " pictures of motions of at most " +
                    FormatDouble(frames) + " frames",
                request.item, "correct the rates of the motions, or draw those of one rate");
  }
  const int count = std::max(1, static_cast<int>(pictures_of_all));
  const auto draw = [&](int picture) -> Expected<cv::Mat> {
    const cv::Mat image = ToImage(grid.At(picture / rate), options->scale);
    return image(cv::Rect(0, 0, image.cols / 2 * 2, image.rows / 2 * 2)).clone();
  };
  const auto pictures = WriteVideo(request.item, rate, count, draw, request.output);
  if (!pictures) return Forward(pictures);
  StageOutcome outcome;
  outcome.summary = {{"rows", rows->size()}, {"pictures", *pictures}, {"without", SourcesWithout(request, *rows)}};
  return outcome;
}

}  // namespace mocurate
