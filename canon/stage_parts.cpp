#include "canon/stage_parts.h"

#include <algorithm>

#include "canon/frames/level.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/text.h"
#include "core/motion/gaps.h"

namespace mocurate {

Expected<Clip> ReadMotionClip(const StageInput& input, std::vector<Finding>* findings) {
  auto dataset = ReadDataset(input.path);
  if (dataset) {
    if (dataset->clips.size() != 1) {
      return Fail(ErrorCode::kInconsistent,
                  Counted(static_cast<long long>(dataset->clips.size()), "clip") + ", one expected", input.name);
    }
    if (findings != nullptr) *findings = dataset->findings;
    return dataset->clips.front();
  }
  auto given = ReadEvidence(input.path, findings);
  if (!given) return Forward(dataset);
  if (!given->motion) {
    return Fail(ErrorCode::kInconsistent, "the clip has no motion, only evidence", input.name,
                "set fitting.method to something other than none");
  }
  return given;
}

Status LevelByFloor(const StageInput& input, Clip& clip) {
  const auto floor = ReadJson(input.path);
  if (!floor) return Forward(floor);
  return GuardJson(input.name, [&] {
    if (!floor->is_null()) LevelClip(floor->get<FloorPlane>(), clip);
  });
}

Status CheckFrameSteps(const Clip& clip) {
  const double step_s = clip.motion ? clip.motion->rate.FrameTime(1) : 0.0;
  if (step_s <= kMaxGap_s) return {};
  return Fail(ErrorCode::kInconsistent,
              "its frames lie " + RoundedText(step_s) + " s apart; motion is estimated between frames at most " +
                  RoundedText(kMaxGap_s) + " s apart",
              clip.id(),
              "correct the rate of its source (ingest.source.rate), or leave canon.rate and canon.trim empty");
}

void SortById(std::vector<Clip>& clips) {
  std::sort(clips.begin(), clips.end(), [](const Clip& a, const Clip& b) { return a.id() < b.id(); });
}

}  // namespace mocurate
