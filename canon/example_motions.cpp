#include "canon/example_motions.h"

#include "canon/recipes/spans_file.h"
#include "canon/stage_parts.h"
#include "canon/trim/trim.h"
#include "core/base/text.h"
#include "core/motion/operations.h"

namespace mocurate {

Expected<std::map<std::string, std::vector<Motion>>> ReadExamples(const CanonOptions& options,
                                                                  const std::vector<StageInput>& inputs) {
  std::vector<ListedSpan> spans;
  for (const StageInput& input : inputs) {
    if (input.role != kExamplesRole) continue;
    auto read = ReadSpans(input.path);
    if (!read) return Forward(read);
    spans = *std::move(read);
  }
  std::map<std::string, std::vector<Motion>> examples;
  for (const StageInput& input : inputs) {
    if (input.role != kExampleRole) continue;
    auto clip = ReadMotionClip(input, nullptr);
    if (!clip) return Forward(clip);
    clip->evidence = Evidence();
    if (Status near = CheckFrameSteps(*clip); !near) return Forward(near);
    for (const StageInput& floor : inputs) {
      if (floor.role != kExampleFloorRole || floor.name != input.name) continue;
      if (Status levelled = LevelByFloor(floor, *clip); !levelled) return Forward(levelled);
    }
    std::vector<Finding> outside;
    ApplySpans(spans, *clip, outside);
    if (Status few = CheckOverlap(*clip, clip->id()); !few) return Forward(few);
    for (const Finding& finding : outside) {
      if (finding.severity != Severity::kError) continue;
      return Fail(ErrorCode::kConfig, finding.message, finding.clip, "repair canon.trim.by_example.examples");
    }
    if (!options.rate.empty()) {
      const auto rate = FrameRate::Parse(options.rate);
      if (!rate) return Forward(rate);
      *clip = Resample(*clip, *rate);
    }
    TrimOptions marked;
    marked.rule = TrimRule::kAnnotated;
    marked.min_length_s = 0.0;
    for (const KeptSpan& span : FindSpans(marked, *clip, outside)) {
      if (span.end - span.begin < 2) {
        return Fail(ErrorCode::kConfig,
                    "the marked span of '" + span.label + "' at " +
                        RoundedText(clip->motion->rate.FrameTime(span.begin)) + " s is shorter than two frames",
                    clip->id(), "mark a longer span in canon.trim.by_example.examples");
      }
      const auto cut = Cut(*clip, span.begin, span.end);
      if (!cut) return Forward(cut);
      examples[span.label].push_back(*cut->motion);
    }
  }
  return examples;
}

}  // namespace mocurate
