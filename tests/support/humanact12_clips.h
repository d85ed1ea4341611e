#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/formats/humanact12_pickle.h"

namespace mocurate {

/// All clips of `humanact12poses.pkl`.
inline Expected<std::vector<HumanAct12Clip>> ParseHumanAct12Pickle(std::string_view bytes, const std::string& name) {
  const Expected<HumanAct12Archive> archive = HumanAct12Archive::Open(bytes, name);
  if (!archive) return Forward(archive);
  std::vector<HumanAct12Clip> clips;
  for (std::size_t i = 0; i < archive->size(); ++i) {
    Expected<HumanAct12Clip> clip = archive->Clip(i);
    if (!clip) return Forward(clip);
    clips.push_back(std::move(*clip));
  }
  return clips;
}

}  // namespace mocurate
