#include "train/data/training_windows.h"

#include <algorithm>
#include <numeric>

#include "core/motion/operations.h"
#include "train/data/batches.h"

namespace mocurate {
namespace {

/// Appends the windows of a clip to `clips`.
Status AddWindows(const Clip& clip, int frames, std::vector<Clip>& clips) {
  const int all = clip.motion ? clip.motion->frame_count() : 0;
  if (all < frames) {
    clips.push_back(clip);
    return {};
  }
  for (int begin = 0; begin + frames <= all; begin += frames) {
    Expected<Clip> window = Cut(clip, begin, begin + frames);
    if (!window) return Forward(window);
    clips.push_back(std::move(*window));
  }
  return {};
}

}  // namespace

Expected<Dataset> TrainingWindows(const Dataset& set, const NetworkOptions& network, bool test) {
  const Expected<TrainingRows> rows =
      SelectTrainingRows(PackTrainingSet(set), network.data, false, network.seed(), 0.0);
  if (!rows) return Forward(rows);
  std::vector<int> chosen = rows->train;
  const Split* split = set.FindSplit(rows->split);
  if (test && split != nullptr) chosen.insert(chosen.end(), split->test.begin(), split->test.end());
  std::vector<Clip> clips;
  std::vector<bool> trains;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const Clip& clip = set.clips[static_cast<std::size_t>(chosen[i])];
    if (Status cut = AddWindows(clip, static_cast<int>(network.data.frames), clips); !cut) return Forward(cut);
    trains.resize(clips.size(), i < rows->train.size());
  }
  std::vector<std::size_t> order(clips.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return clips[a].id() < clips[b].id(); });
  Dataset windows = set;
  windows.clips.clear();
  Split own;
  own.name = rows->split.empty() ? "all" : rows->split;
  own.rule = "windows of the clips that " + network.name + " learned from";
  own.leak_check = split != nullptr ? split->leak_check : "";
  for (const std::size_t i : order) {
    (trains[i] ? own.train : own.test).push_back(static_cast<int>(windows.clips.size()));
    windows.clips.push_back(std::move(clips[i]));
  }
  windows.splits = {std::move(own)};
  windows.findings.clear();
  return windows;
}

}  // namespace mocurate
