#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "fitting/evidence/skeleton_tracks.h"
#include "tests/ingest/sources.h"

namespace mocurate {

/// Joint tracks of a recorded set, as the stage `ingest` gives them.
struct RealClip {
  std::string id;
  std::string label;
  FrameRate rate;
  SkeletonTracks tracks;
};

/// About `clips` clips of a declared source (configs/sources), evenly chosen, by person.
inline std::map<std::string, std::vector<RealClip>> ReadPeople(const std::string& source, const SkeletonPtr& skeleton,
                                                               std::size_t clips) {
  std::map<std::string, std::vector<RealClip>> people;
  const auto discovery = Discover(Declared(source));
  if (!discovery) return people;
  const std::size_t step = std::max<std::size_t>(1, discovery->items.size() / clips);
  for (std::size_t i = 0; i < discovery->items.size(); i += step) {
    const Ingested ingested = RunIngest(discovery->items[i], "benchmark");
    if (!ingested.outcome || !ingested.clip.evidence.tracks) continue;
    auto tracks = MapTracks(*ingested.clip.evidence.tracks, skeleton);
    if (!tracks) continue;
    people[ingested.clip.identity.person].push_back(
        {ingested.clip.id(), ingested.clip.label, ingested.clip.rate, std::move(*tracks)});
  }
  return people;
}

}  // namespace mocurate
