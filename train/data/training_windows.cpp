#include <algorithm>

#include "core/motion/gaps.h"
#include "core/motion/operations.h"
#include "train/data/batches.h"

namespace mocurate {
namespace {

enum class WindowPart { kTrain, kValidation, kTest };

struct ClipWindow {
  Clip clip;
  WindowPart part;
};

/// Rows for choosing clips: ids, labels and lengths without a motion.
TrainingSet HeadersOf(const Dataset& set) {
  TrainingSet headers;
  headers.labels = set.labels;
  headers.splits = set.splits;
  for (const Clip& clip : set.clips) {
    TrainingSet::Clip header;
    header.id = clip.id();
    header.person = clip.identity.person;
    header.label = set.LabelIndex(clip.label);
    header.frames = clip.motion ? clip.motion->frame_count() : 0;
    headers.clips.push_back(std::move(header));
  }
  return headers;
}

/// Removes the clips without an observation, as a training set leaves them out.
void RemoveInferred(Dataset& set, InferredLoss& lost) {
  std::vector<int> new_row;
  std::vector<Clip> kept;
  for (Clip& clip : set.clips) {
    const bool gone = clip.motion && IsAllInferred(*clip.motion);
    new_row.push_back(gone ? -1 : static_cast<int>(kept.size()));
    lost.skipped += gone ? 1 : 0;
    lost.frames += gone ? clip.motion->frame_count() : 0;
    if (!gone) kept.push_back(std::move(clip));
  }
  set.clips = std::move(kept);
  RenumberRows(new_row, set.splits);
}

/// Appends the windows of a clip.
Status AddWindows(const Clip& given, const NetworkOptions& network, WindowPart part, std::vector<ClipWindow>& windows,
                  InferredLoss& lost) {
  const Expected<std::optional<Clip>> shorter = WithoutInferred(given);
  if (!shorter) return Forward(shorter);
  const Clip& clip = *shorter ? **shorter : given;
  if (*shorter) {
    ++lost.shortened;
    lost.frames += given.motion->frame_count() - clip.motion->frame_count();
  }
  const int all = clip.motion->frame_count(), frames = static_cast<int>(network.data.frames);
  if (all < frames) {
    const bool one_length = network.actor.coders == ActorCoders::kFullyConnected;
    if (!one_length) windows.push_back({clip, part});
    return {};
  }
  for (int begin = 0; begin + frames <= all; begin += frames) {
    Expected<Clip> window = Cut(clip, begin, begin + frames);
    if (!window) return Forward(window);
    windows.push_back({std::move(*window), part});
  }
  return {};
}

}  // namespace

Expected<Dataset> TrainingWindows(Dataset set, const NetworkOptions& network, bool test) {
  InferredLoss lost;
  RemoveInferred(set, lost);
  const TrainingSet headers = HeadersOf(set);
  const Expected<TrainingRows> rows = SelectTrainingRows(headers, network.data, false, network.seed(), 0.0);
  if (!rows) return Forward(rows);
  const Split* split = set.FindSplit(rows->split);
  std::vector<std::pair<int, WindowPart>> chosen;
  for (const int row : rows->train) chosen.emplace_back(row, WindowPart::kTrain);
  if (split != nullptr && !split->validation.empty()) {
    const Expected<TrainingRows> held = SelectTrainingRows(headers, network.data, true, network.seed(), 0.0);
    if (!held) return Forward(held);
    for (const int row : held->validation) chosen.emplace_back(row, WindowPart::kValidation);
  }
  if (test && split != nullptr) {
    for (const int row : split->test) chosen.emplace_back(row, WindowPart::kTest);
  }
  Split own;
  own.name = rows->split.empty() ? "all" : rows->split;
  own.rule = "windows of the training clips of " + network.name;
  own.leak_check = split != nullptr ? split->leak_check : "";
  std::vector<ClipWindow> windows;
  for (const auto& [row, part] : chosen) {
    const auto at = static_cast<std::size_t>(row);
    if (headers.clips[at].frames < 1 || headers.clips[at].label < 0) continue;
    if (Status cut = AddWindows(set.clips[at], network, part, windows, lost); !cut) return Forward(cut);
    set.clips[at].motion.reset();  // its windows have it
  }
  std::sort(windows.begin(), windows.end(),
            [](const ClipWindow& a, const ClipWindow& b) { return a.clip.id() < b.clip.id(); });
  set.clips.clear();
  for (ClipWindow& window : windows) {
    std::vector<int>& part = window.part == WindowPart::kTrain        ? own.train
                             : window.part == WindowPart::kValidation ? own.validation
                                                                      : own.test;
    part.push_back(static_cast<int>(set.clips.size()));
    set.clips.push_back(std::move(window.clip));
  }
  set.splits = {std::move(own)};
  set.findings.clear();
  if (auto about = lost.About()) set.findings.push_back(*std::move(about));
  return set;
}

}  // namespace mocurate
