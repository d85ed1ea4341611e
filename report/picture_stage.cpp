#include <map>

#include "core/store/store.h"
#include "report/options.h"
#include "report/pictures.h"
#include "report/stages.h"

namespace mocurate {

Expected<StageOutcome> PictureStage(const StageRequest& request) {
  const auto options = OptionsFromJson<PictureOptions>(request.options, "picture");
  if (!options) return Forward(options);
  std::map<std::string, std::filesystem::path> depth_files;
  Expected<Clip> evidence = Fail(ErrorCode::kInternal, "a picture needs evidence", request.item);
  Expected<Dataset> fit = Fail(ErrorCode::kInternal, "a picture needs a fit", request.item);
  for (const StageInput& input : request.inputs) {
    if (input.role == "depth") depth_files[input.name] = input.path;
    if (input.role == "evidence") evidence = ReadEvidence(input.path);
    if (input.role == "fit") fit = ReadDataset(input.path);
  }
  if (!evidence) return Forward(evidence);
  if (!fit) return Forward(fit);
  if (fit->clips.empty()) return Fail(ErrorCode::kInconsistent, "the fit holds no clip", request.item);
  ResolveDepthFiles(depth_files, evidence->evidence);
  const Clip& clip = fit->clips.front();
  const int middle = clip.motion->frame_count() / 2;
  Status drawn;
  switch (options->kind) {
    case PictureKind::kClip:
      drawn = WriteClipPicture(clip, evidence->evidence, static_cast<int>(options->stills), request.output);
      break;
    case PictureKind::kOverlay:
      drawn = WriteBodyOverlay(clip, evidence->evidence, 0, middle, request.output);
      break;
    case PictureKind::kCloud:
      drawn = WriteCloudPicture(clip, evidence->evidence, middle, request.output);
      break;
  }
  if (!drawn) return Forward(drawn);
  return StageOutcome();
}

}  // namespace mocurate
