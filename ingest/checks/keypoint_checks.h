#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/formats/openpose.h"

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

}  // namespace mocurate
