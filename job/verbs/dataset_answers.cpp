#include "job/verbs/dataset_answers.h"

#include <nlohmann/json.hpp>

#include "core/base/log.h"
#include "core/base/terminal.h"

namespace mocurate {

void AnswerWithDataset(CommonArguments& common, const Dataset& dataset, const std::vector<Finding>& findings,
                       const std::string& text, const nlohmann::json& more) {
  for (const Finding& finding : findings) {
    if (finding.severity == Severity::kInfo) continue;
    LogWarning((finding.clip.empty() ? "" : finding.clip + ": ") + finding.message);
  }
  if (!common.json) {
    if (!common.quiet) Print("%s\n", text.c_str());
    return;
  }
  std::int64_t frames = 0;
  for (const Clip& clip : dataset.clips) frames += clip.motion->frame_count();
  nlohmann::json answer = {{"clips", dataset.clips.size()},
                           {"frames", frames},
                           {"labels", dataset.labels},
                           {"splits", nlohmann::json::array()},
                           {"findings", findings}};
  for (const Split& split : dataset.splits) {
    answer["splits"].push_back({{"name", split.name},
                                {"train", split.train.size()},
                                {"validation", split.validation.size()},
                                {"test", split.test.size()},
                                {"leak_check", split.leak_check}});
  }
  answer.update(more);
  common.answered = true;
  PrintJson(answer);
}

}  // namespace mocurate
