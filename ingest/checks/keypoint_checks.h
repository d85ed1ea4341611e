#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/formats/openpose.h"
#include "ingest/inspect/measure.h"

namespace mocurate {

/// Errors of a detector's numbers that are of another range than they are read as: "keypoints_not_pixels" where no
/// point is 2 px away from the corner of the image (OpenPose's --keypoint_scale 3 and 4), "confidence_range" where most
/// confidences are more than 1.5 (per cent). The value is the largest of them. Nothing of fewer than 10 points.
std::vector<Finding> CheckKeypointNumbers(const std::vector<OpenPosePerson>& people);

/// People of an image, by their points.
using ImagePoses = std::vector<std::vector<DetectedKeypoint>>;

/// "keypoint_far" (warning) of points of a camera that are 20 times as far from the corner of the image as nine in ten
/// are, or more: outside of any image. Value: how far, in px; its frames span all of them, the message names the first
/// by its file, `names` (F), person and point. Those points are not detected from then on. Nothing of fewer than 10
/// points.
std::optional<Finding> ExcludeFarKeypoints(const std::vector<std::string>& names, std::vector<ImagePoses>& frames);

/// "confidence_range" (warning) of points of a camera whose confidence is more than 1.5 where most are of the right
/// range: their numbers are damaged, or not the detector's. Value: the largest; place and what becomes of them as
/// above.
std::optional<Finding> ExcludeImplausibleConfidences(const std::vector<std::string>& names,
                                                     std::vector<ImagePoses>& frames);

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
class PointsNotSeen {
 public:
  void Add(const OpenPoseFrame& frame, const std::string& file);
  /// "uncertain_points" (coordinates, and the confidence 0) and "keypoints_not_finite" (NaN, Infinity or null).
  std::vector<Finding> Findings() const;

 private:
  struct OfFiles {
    long long points = 0;
    std::string first_file;  ///< that has such
  };
  OfFiles unsure_, not_finite_;
};

}  // namespace mocurate
