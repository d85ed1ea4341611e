#pragma once

#include <string_view>

#include "ingest/options.h"

namespace mocurate {

/// What the clips of a source hold when they are ingested.
enum class Gives { kNothing, kJointTracks, kDepthViews, kKeypoints, kKeypointsAndDepth, kMotion };

/// One row per format: what it is called and what it gives. Who has to know asks here.
struct FormatFacts {
  SourceFormat format;
  const char* name;  ///< as a configuration says it
  Gives gives;
  bool rotations;  ///< motion comes with rotations; of `motions` the file says it
};

const FormatFacts& FactsOf(SourceFormat format);
/// The same by its name; of `none` for a name that no format has.
const FormatFacts& FactsOf(std::string_view name);

/// What the clips of a source hold: that of its format, and depth views where it declares them beside keypoints.
Gives GivesOf(const SourceOptions& source);

/// What an inspection calls clips of a source of this format ("amc").
std::string InspectedAs(SourceFormat format);

/// "joint tracks", ...
const char* Name(Gives gives);

}  // namespace mocurate
