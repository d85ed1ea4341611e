#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/options.h"

namespace mocurate {

/// The body that a person's clips are fitted with.
struct PersonBody {
  SkeletonPtr skeleton;             ///< with the person's own directions of bones (WithOwnDirections)
  std::vector<double> bone_length;  ///< (J) metres; empty: not known
};

/// One person's bone lengths and where they come from.
struct Proportions {
  std::string person;
  SkeletonPtr skeleton;             ///< with the person's own directions of bones
  std::vector<double> bone_length;  ///< (J) metres, whole 0.1 mm
  std::vector<int> samples;         ///< (J) observed lengths behind each bone; 0: from the rest skeleton
  std::vector<double> bone_spread;  ///< (J) metres, robust spread over frames before any fit
  std::vector<std::string> clips;   ///< ids, sorted
  int frames = 0;
  double scale = 1.0;  ///< of the person against the rest skeleton
};

/// Median lengths and own directions of all clips, then the lengths refined: up to refine_clips of them are fitted with
/// their bones free around the medians, and the bones become the median of those fits. No clips: the rest lengths.
/// Rounded to 0.1 mm. Error kInternal if a fit fails.
Expected<Proportions> EstimateProportions(const std::vector<SkeletonTracks>& clips, const SkeletonPtr& skeleton,
                                          const ProportionsOptions& options);

/// Lengths in whole 0.1 mm.
std::vector<double> RoundedLengths(std::vector<double> lengths);

/// {"person", "flesh": the skeleton's, [] where it is not known, "skeleton", "bone_length_m": {joint: m},
/// "rest_direction": {joint: [x, y, z]} of joints where it is not
///  `rest`'s, "samples": {joint: n}, "bone_spread_mm": {joint: mm}, "clips", "frames", "scale", "stature_m"}
nlohmann::json ProportionsJson(const Proportions& proportions, const Skeleton& rest);

/// The body of a proportions artifact on `skeleton`; landmarks that it does not name have rest length times the
/// person's scale. Error kInconsistent for another skeleton or a missing joint, kMalformed for what is no length,
/// direction or flesh.
Expected<PersonBody> BodyFromJson(const nlohmann::json& json, const SkeletonPtr& skeleton, const std::string& where);

/// Height of the rest pose with these bones: highest minus lowest joint, metres. Of a rest pose in which nobody stands
/// (all bones along one axis) the way along the bones from head to toes instead.
double Stature(const Skeleton& skeleton, const std::vector<double>& bone_length);

}  // namespace mocurate
