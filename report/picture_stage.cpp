#include "core/base/file.h"
#include "report/clip_page.h"
#include "report/filmstrip.h"
#include "report/options.h"
#include "report/pictures.h"
#include "report/stages.h"

namespace mocurate {

Expected<StageOutcome> PictureStage(const StageRequest& request) {
  const auto options = OptionsFromJson<PictureOptions>(request.options, "picture");
  if (!options) return Forward(options);
  const auto drawn_clip = ReadDrawnClip(request);
  if (!drawn_clip) return Forward(drawn_clip);
  const Clip& clip = drawn_clip->fitted;
  const Evidence& evidence = drawn_clip->evidence.evidence;
  const int middle = clip.motion->frame_count() / 2;
  Status drawn;
  switch (options->kind) {
    case PictureKind::kClip:
      drawn = WriteClipPicture(clip, evidence, request.output);
      break;
    case PictureKind::kOverlay:
      drawn = WriteBodyOverlay(clip, evidence, 0, middle, request.output);
      break;
    case PictureKind::kCloud:
      drawn = WriteCloudPicture(clip, evidence, middle, request.output);
      break;
  }
  if (!drawn) return Forward(drawn);
  return StageOutcome();
}

Expected<StageOutcome> ClipPageStage(const StageRequest& request) {
  const auto options = OptionsFromJson<ClipPageOptions>(request.options, "clip_page");
  if (!options) return Forward(options);
  ClipPageInput input;
  input.options = *options;
  auto drawn = ReadDrawnClip(request, &input.findings);
  if (!drawn) return Forward(drawn);
  input.clip = std::move(*drawn);
  const auto page = MakeClipPage(input);
  if (!page) return Forward(page);
  if (Status written = WriteFile(request.output, *page); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = {{"bytes", page->size()}};
  return outcome;
}

}  // namespace mocurate
