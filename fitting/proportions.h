#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "fitting/evidence/skeleton_tracks.h"
#include "fitting/options.h"

namespace mocurate {

/// The body used to fit a person's clips.
struct PersonBody {
  SkeletonPtr skeleton;               ///< with the person's own directions of bones (WithOwnDirections)
  std::vector<double> bone_length;    ///< (J) metres; empty: unknown
  std::vector<double> place_sigma{};  ///< (J) or empty: metres per axis, of the places of markers, learnt from trials
};

/// One person's bone lengths and their sources.
struct Proportions {
  std::string person;
  SkeletonPtr skeleton;             ///< with the person's own directions of bones
  std::vector<double> bone_length;  ///< (J) metres, whole 0.1 mm
  std::vector<int> samples;         ///< (J) observed lengths behind each bone; 0: from the rest skeleton
  std::vector<double> bone_sigma;   ///< (J) metres, robust standard deviation over frames before any fit
  std::vector<std::string> clips;   ///< ids, sorted
  int frames = 0;
  double scale = 1.0;                 ///< of the person against the rest skeleton
  std::vector<double> place_sigma{};  ///< (J) or empty: metres per axis, of the places of markers
};

/// Median lengths and own directions over all clips. Without clips: rest lengths. Rounded to 0.1 mm.
Proportions EstimateProportions(const std::vector<SkeletonTracks>& clips, const SkeletonPtr& skeleton,
                                const ProportionsOptions& options);

/// Lengths in whole 0.1 mm.
std::vector<double> RoundedLengths(std::vector<double> lengths);

/// {"person", "body_shape": the skeleton's, [] if unknown, "skeleton", "bone_length_m": {joint: m}, "rest_direction":
/// {joint: [x, y, z]} of joints where it differs from `rest`, "samples": {joint: n}, "bone_spread_mm": {joint: mm},
/// "clips", "frames", "scale", "stature_m"}, of markers "place_sigma_mm": {joint: mm}.
nlohmann::json ProportionsJson(const Proportions& proportions, const Skeleton& rest);

/// The body of a proportions artifact on `skeleton`; landmarks that it does not name have rest length times the
/// person's scale. Error kInconsistent for another skeleton or a missing joint, kMalformed for an invalid length,
/// direction or body shape.
Expected<PersonBody> BodyFromJson(const nlohmann::json& json, const SkeletonPtr& skeleton, const std::string& where);

/// Height of the rest pose with these bones: highest minus lowest joint, metres. For a rest pose that is not upright
/// (all bones along one axis): the length along the bones from head to toes.
double Stature(const Skeleton& skeleton, const std::vector<double>& bone_length);

}  // namespace mocurate
