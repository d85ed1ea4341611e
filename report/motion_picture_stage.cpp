#include "report/motion_picture_stage.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/text.h"
#include "report/plot.h"
#include "report/stages.h"

namespace mocurate {

Expected<std::vector<MotionRow>> ReadRows(const StageRequest& request, const MotionPictureOptions& options) {
  std::vector<NamedMotions> sets;
  for (const StageInput& input : request.inputs) {
    if (input.role != "motions") continue;
    auto set = ReadDataset(input.path);
    if (!set) return Forward(set);
    sets.push_back({input.name, std::move(*set)});
  }
  auto rows = ChooseMotionRows(sets, options);
  if (!rows || options.figure != FigureChoice::kSkin) return rows;
  const StageInput* body = FindInput(request, "body");
  if (body == nullptr) return Fail(ErrorCode::kInternal, "drawing a skin needs a body", request.item);
  for (MotionRow& row : *rows) {
    if (row.clip.motion->joints_only()) {
      return Fail(ErrorCode::kUnsupported, "the motion has no rotations to pose a skin with", row.clip.id(),
                  "draw bones or capsules, or fit it first: mocurate fit");
    }
    auto skin = ReadSkin(body->path, *row.clip.motion->skeleton);
    if (!skin) return Forward(skin);
    row.skin = std::move(*skin);
  }
  return rows;
}

std::vector<std::string> SourcesWithout(const StageRequest& request, const std::vector<MotionRow>& rows) {
  std::vector<std::string> without;
  for (const StageInput& input : request.inputs) {
    const bool shown =
        std::any_of(rows.begin(), rows.end(), [&](const MotionRow& row) { return row.method == input.name; });
    if (input.role == "motions" && !shown) without.push_back(input.name);
  }
  return without;
}

Expected<StageOutcome> MotionPictureStage(const StageRequest& request) {
  const auto options = OptionsFromJson<MotionPictureOptions>(request.options, "draw");
  if (!options) return Forward(options);
  const auto rows = ReadRows(request, *options);
  if (!rows) return Forward(rows);
  const Drawing drawing = DrawMotionRows(*rows, *options);
  constexpr double kMostPixels = 2e8;  // OpenCV's image of them takes 0.6 GB
  const double pixels = drawing.width * drawing.height * options->scale * options->scale;
  if (options->format == PictureFormat::kPng && pixels > kMostPixels) {
    return Fail(ErrorCode::kUsage, RoundedText(pixels / 1e6, 3) + " million pixels, a PNG has 200 million at most",
                "picture", "use a smaller --scale, fewer rows or stills, or .svg");
  }
  const std::string bytes = options->format == PictureFormat::kSvg ? ToSvg(drawing) : ToPng(drawing, options->scale);
  if (Status written = WriteFile(request.output, bytes); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = {{"rows", rows->size()},
                     {"width", drawing.width},
                     {"height", drawing.height},
                     {"without", SourcesWithout(request, *rows)}};
  return outcome;
}

Expected<StageOutcome> PlotStage(const StageRequest& request) {
  if (request.inputs.empty()) return Fail(ErrorCode::kInternal, "a plot needs its numbers", request.item);
  const auto json = ReadJson(request.inputs.front().path);
  if (!json) return Forward(json);
  const auto plots = PlotsOf(*json);
  if (!plots) return Forward(plots);
  if (Status written = WriteFile(request.output, ToSvg(DrawPlots(*plots, json->value("columns", 3)))); !written) {
    return Forward(written);
  }
  return StageOutcome();
}

}  // namespace mocurate
