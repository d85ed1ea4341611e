#pragma once

#include <vector>

#include "core/motion/clip.h"

namespace mocurate {

/// Image of a view that is nearest to a time, at most half a step from it; -1: none.
int ImageAt(const KeypointView& view, double time_s, double step_s);

/// Distances of a detection's keypoints from the projected joints of a frame, px. `joint_of`: joint of each keypoint,
/// or -1. Undetected keypoints, and joints behind the camera, are left out.
std::vector<double> DistancesFromJoints(const KeypointView& view, int image, int person,
                                        const std::vector<int>& joint_of, const Motion& motion, int frame);

/// The detected person who matches a motion.
struct SeenPerson {
  int index = -1;  ///< -1: none
  double median_px = 0.0;
};
/// The one with the smallest median distance, below a quarter of the body's height in the image.
SeenPerson FindPerson(const KeypointView& view, int image, const std::vector<int>& joint_of, const Motion& motion,
                      int frame);

}  // namespace mocurate
