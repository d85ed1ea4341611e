#pragma once

#include <string>
#include <vector>

#include "core/formats/openpose.h"
#include "ingest/inspect/measure.h"

namespace mocurate {

/// How well one layout explains detected people.
struct KeypointLayoutScore {
  std::string layout;
  /// Median over people of the mean distance of log bone lengths, over the common scale, from those of an adult; 0 is a
  /// body flat in the image. Foreshortening gives 0.1 to 0.4, a wrong order 0.6 and more.
  double mismatch = 0.0;
  int people = 0;  ///< detections with enough bones to tell
};

/// All layouts with as many points as the people have, best first.
std::vector<KeypointLayoutScore> ScoreKeypointLayouts(const std::vector<OpenPosePerson>& people);

/// The layout of a detector's people: of many frames and views, as files do not declare it. Value "BODY_25B"; empty
/// where no layout of this many points fits, where two fit alike, or where no person shows enough bones.
Measured EstimateKeypointLayout(const std::vector<OpenPosePerson>& people);

/// Points of several files that are taken as not seen.
struct PointsOfFiles {
  long long points = 0;
  std::string first_file;  ///< that has such

  void Add(int of_file, const std::string& file);
};

/// Of points that have coordinates and the confidence 0 (OpenPoseFrame::uncertain_points).
std::string UnsurePointsWords(const PointsOfFiles& unsure);

/// Of points that are NaN, Infinity or null (OpenPoseFrame::not_finite).
std::string NotFiniteWords(const PointsOfFiles& not_finite);

}  // namespace mocurate
