#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "fitting/evidence/motion_tracks.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "tests/ingest/sources.h"

namespace mocurate {

/// Joint tracks of a recorded set, as the stage `ingest` writes them.
struct RealClip {
  std::string id;
  std::string label;
  FrameRate rate;
  SkeletonTracks tracks;
  std::optional<Motion> given;  ///< of sets with motion (HDM05): the truth; `tracks` are its noisy joints
};

/// Adds white noise of `rms_m` metres RMS length to tracks.
inline void AddNoise(const std::string& item, double rms_m, SkeletonTracks& tracks) {
  Random random(1, "noise", item);
  const double sigma = rms_m / std::sqrt(3.0);
  for (int f = 0; f < tracks.frames(); ++f) {
    for (int j = 0; j < tracks.joints(); ++j) {
      const Vector3d noise(random.Normal(), random.Normal(), random.Normal());
      tracks.positions.at(f, j) += sigma * noise;
    }
  }
}

/// About `clips` clips of a declared source (configs/sources), evenly chosen, by person. Motion of a set becomes tracks
/// of its joints with white noise of `rms_m` metres. Such tracks keep the set's skeleton, because an .asf defines its
/// own directions.
inline std::map<std::string, std::vector<RealClip>> ReadPeople(const std::string& source, const SkeletonPtr& skeleton,
                                                               std::size_t clips, double rms_m = 0.03) {
  std::map<std::string, std::vector<RealClip>> people;
  const auto discovery = Discover(Declared(source));
  if (!discovery) return people;
  const std::size_t step = std::max<std::size_t>(1, discovery->items.size() / clips);
  for (std::size_t i = 0; i < discovery->items.size(); i += step) {
    const Ingested ingested = RunIngest(discovery->items[i], "benchmark");
    if (!ingested.outcome) continue;
    const Clip& clip = ingested.clip;
    const bool given = !clip.evidence.tracks && clip.motion;
    auto tracks = TracksOfClip(clip, given ? clip.motion->skeleton : skeleton, OtherJoints::kLeaveOut);
    if (!tracks) continue;
    if (given) {
      AddNoise(clip.id(), rms_m, *tracks);
      // The recorded rotations are the truth of the comparison.
      tracks->rotation.clear();
      tracks->rotation_confidence.clear();
    }
    people[clip.identity.person].push_back({clip.id(), clip.label, clip.motion ? clip.motion->rate : clip.rate,
                                            std::move(*tracks), given ? clip.motion : std::nullopt});
  }
  return people;
}

}  // namespace mocurate
