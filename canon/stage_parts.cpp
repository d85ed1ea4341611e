#include "canon/stage_parts.h"

#include <algorithm>

namespace mocurate {

const StageInput* FindInput(const StageRequest& request, const std::string& role) {
  for (const StageInput& input : request.inputs) {
    if (input.role == role) return &input;
  }
  return nullptr;
}

void SortById(std::vector<Clip>& clips) {
  std::sort(clips.begin(), clips.end(), [](const Clip& a, const Clip& b) { return a.id() < b.id(); });
}

nlohmann::json SplitSummary(const Split& split) {
  return {{"name", split.name},        {"train", split.train.size()}, {"validation", split.validation.size()},
          {"test", split.test.size()}, {"rule", split.rule},          {"leak_check", split.leak_check}};
}

}  // namespace mocurate
