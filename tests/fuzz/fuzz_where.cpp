/// Any bytes as a condition on clips: it is rejected at a column, or it is true exactly where its negation is
/// false.

#include <cstddef>
#include <cstdint>
#include <string>

#include "canon/values/where.h"

namespace {

mocurate::Dataset FuzzClips() {
  mocurate::Dataset dataset;
  for (int i = 0; i < 3; ++i) {
    mocurate::Clip clip;
    clip.identity = {"kard", "p" + std::to_string(i), "a(b)+c", "", "front", "CC0", 0, 10 * i};
    clip.label = i == 0 ? "" : "walk";
    clip.segments = {{0.0, 1.0, "step", "", ""}};
    clip.provenance = {{"style", "old"}};
    clip.motion.emplace();
    clip.motion->joints.frames = 10 * i;
    dataset.clips.push_back(clip);
  }
  mocurate::Split split;
  split.name = "persons";
  split.train = {0, 2};
  dataset.splits = {split};
  return dataset;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto condition = mocurate::Condition::Parse(text, "fuzz");
  if (!condition) {
    const std::string& where = condition.error().where;
    const unsigned long column = std::stoul(where.substr(where.rfind(':') + 1));
    if (column < 1 || column > size + 1 || condition.error().what.empty()) __builtin_trap();
    return 0;
  }
  static const mocurate::Dataset clips = FuzzClips();
  const auto holds = condition->Holds(clips);
  const auto negated = mocurate::Condition::Parse("not (" + text + ")");
  if (!holds || !negated) return 0;  // an unknown split, or an unbalanced bracket
  const auto not_held = negated->Holds(clips);
  for (std::size_t row = 0; row < clips.clips.size(); ++row) {
    if ((*holds)[row] == (*not_held)[row]) __builtin_trap();
  }
  if (!condition->CountTests(clips)) __builtin_trap();
  condition->FindUnknownValues(clips);
  return 0;
}
