#pragma once

#include <vector>

#include "core/base/finding.h"
#include "core/formats/openpose.h"

namespace mocurate {

/// Errors of a detector's numbers that are of another range than they are read as: "keypoints_not_pixels" where no
/// point is 2 px away from the corner of the image (OpenPose's --keypoint_scale 3 and 4), "confidence_range" where most
/// confidences are more than 1.5 (per cent). The value is the largest of them. Nothing of fewer than 10 points.
std::vector<Finding> DoubtKeypointNumbers(const std::vector<OpenPosePerson>& people);

}  // namespace mocurate
