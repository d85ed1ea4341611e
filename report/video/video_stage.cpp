#include "report/drawn_clip.h"
#include "report/stages.h"
#include "report/video/clip_video.h"

namespace mocurate {

Expected<StageOutcome> ClipVideoStage(const StageRequest& request) {
  const auto options = OptionsFromJson<ClipVideoOptions>(request.options, "clip_video");
  if (!options) return Forward(options);
  const auto drawn = ReadDrawnClip(request);
  if (!drawn) return Forward(drawn);
  const auto pictures = WriteClipVideo(*drawn, *options, request.output);
  if (!pictures) return Forward(pictures);
  StageOutcome outcome;
  outcome.summary = {{"pictures", *pictures}};
  return outcome;
}

}  // namespace mocurate
