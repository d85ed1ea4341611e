#pragma once

#include <string>
#include <vector>

#include "core/base/sha256.h"
#include "tests/canon/moving_clips.h"

namespace mocurate {

/// Six clips of three persons, labels a, b and c (no clip), fine labels, segments, a split by person and findings.
/// Rows by id: p1 a, p1 b, p2 a, p2 b, p3 a, p3 b, of 40 to 45 frames at 30 Hz; the last of 60 Hz and no label.
inline Dataset SixClips() {
  std::vector<Clip> clips;
  for (int i = 0; i < 6; ++i) {
    Clip clip = ClipMoving("p" + std::to_string(1 + i / 2), i % 2 == 0 ? "a" : "b", 40 + i, 5, 30, 1.0 + 0.1 * i);
    clip.identity.session = i < 3 ? "morning" : "";
    clip.identity.view = "front view";
    clip.role = "train";
    clip.provenance = {{"style", i == 1 ? "old man" : "neutral"}};
    clip.segments = {{0.0, 0.5, "step", "", "annotated"}, {0.5, 1.0, i == 2 ? "step" : "idle", "", "annotated"}};
    clips.push_back(std::move(clip));
  }
  clips[0].fine_label = "a slowly";
  clips[1].fine_label = "b at once";
  clips[5].label = "";
  clips[5].rate = clips[5].motion->rate = FrameRate{60, 1};
  Dataset dataset = SetOf(std::move(clips));
  dataset.labels = {"a", "b", "c"};
  dataset.fine_labels = {{"a slowly", 0}, {"b at once", 1}};
  Split split;
  split.name = "persons";
  split.train = {0, 1, 4, 5};
  split.validation = {2};
  split.test = {3};
  split.rule = "drawn";
  split.leak_check = "ok: nothing";
  dataset.splits = {split};
  for (const int row : {0, 0, 2}) {
    Finding finding;
    finding.clip = dataset.clips[static_cast<std::size_t>(row)].id();
    finding.code = "position_jump";
    finding.frame_begin = static_cast<int>(dataset.findings.size());
    finding.frame_end = 10;
    dataset.findings.push_back(finding);
  }
  dataset.recipe = "six clips";
  return dataset;
}

inline std::vector<std::string> IdsOf(const Dataset& dataset) {
  std::vector<std::string> ids;
  for (const Clip& clip : dataset.clips) ids.push_back(clip.id());
  return ids;
}

inline std::vector<std::string> CodesOfFindings(const std::vector<Finding>& findings) {
  std::vector<std::string> codes;
  for (const Finding& finding : findings) codes.push_back(finding.code);
  return codes;
}

}  // namespace mocurate
