#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/store/store.h"
#include "report/options.h"
#include "report/page.h"
#include "report/run_facts.h"
#include "report/stages.h"

namespace mocurate {
namespace {

std::string RankOf(std::size_t position, std::size_t count) {
  if (count == 1) return "the only fit drawn";
  if (position == 0) return "best fit";
  if (position + 1 == count) return "worst fit";
  if (count % 2 == 1 && position == count / 2) return "median fit";
  return "fit " + std::to_string(position + 1) + " of " + std::to_string(count) + " drawn";
}

nlohmann::json FiguresOf(const nlohmann::json& run, const std::string& item) {
  for (const nlohmann::json& clip : Elements(Field(run, "clips"))) {
    if (TextOf(clip, "item") == item) return Field(clip, "fitting");
  }
  return nullptr;
}

Expected<nlohmann::json> ReadRun(const StageInput& input) {
  auto run = ReadJson(input.path);
  if (run && !run->is_object())
    return Fail(ErrorCode::kMalformed, "the summary of the run is not a JSON object", DisplayPath(input.path));
  return run;
}

/// An unreadable clip only loses its strip.
void ReadDrawnClips(const StageRequest& request, ReportInput& input) {
  for (const StageInput& candidate : request.inputs) {
    if (candidate.role != "evidence") continue;
    auto drawn = ReadDrawnClip(request, candidate);
    if (!drawn) {
      input.not_drawn.push_back(candidate.name + ": " + drawn.error().Message());
      continue;
    }
    drawn->figures = FiguresOf(input.run, candidate.name);
    input.drawn.push_back(std::move(*drawn));
  }
  for (std::size_t i = 0; i < input.drawn.size(); ++i) {
    DrawnClip& clip = input.drawn[i];
    clip.rank = NumberOf(clip.figures, "residual_rms_mm") ? RankOf(i, input.drawn.size()) : "given motion";
  }
}

}  // namespace

Expected<StageOutcome> ReportStage(const StageRequest& request) {
  const auto options = OptionsFromJson<ReportOptions>(request.options, "report");
  if (!options) return Forward(options);
  ReportInput input;
  input.options = *options;
  const StageInput *summary = FindInput(request, "run"), *set = FindInput(request, "dataset");
  if (summary == nullptr) return Fail(ErrorCode::kInternal, "the stage report has no summary of a run", request.item);
  auto run = ReadRun(*summary);
  if (!run) return Forward(run);
  input.run = std::move(*run);
  if (set != nullptr) {
    auto dataset = ReadDataset(set->path);
    if (!dataset) return Forward(dataset);
    input.dataset = std::move(*dataset);
  }
  ReadDrawnClips(request, input);
  const std::string page = MakePage(input);
  if (Status written = WriteFile(request.output, page); !written) return Forward(written);
  StageOutcome outcome;
  outcome.summary = {{"bytes", page.size()}, {"drawn", input.drawn.size()}, {"not_drawn", input.not_drawn.size()}};
  return outcome;
}

}  // namespace mocurate
