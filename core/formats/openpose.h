#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// A point in an image as a detector gives it. Not detected: 0, 0, 0.
struct DetectedKeypoint {
  double u_px = 0;
  double v_px = 0;
  double confidence = 0;

  bool detected() const { return confidence > 0; }
};

struct OpenPosePerson {
  std::vector<DetectedKeypoint> pose;  ///< empty: a person entry without keypoints, as the artificial ones may have
};

/// One image of one camera. The file does not declare the layout of the points.
struct OpenPoseFrame {
  std::vector<OpenPosePerson> people;
  int uncertain_points = 0;  ///< had coordinates and the confidence 0, and are read as not detected
  int not_finite = 0;        ///< points of which a number is NaN, Infinity or null, and that are read as not detected
};

/// The keypoints of bodies; ids, face, hands and 3D keypoints are skipped. Error kMalformed with
/// "name:/people/0/pose_keypoints_2d" for a count that is not a multiple of 3, a value that is not a number, a
/// confidence below 0. A point with coordinates and the confidence 0 is not detected, and counted, as is one with NaN,
/// Infinity or null.
Expected<OpenPoseFrame> ParseOpenPose(std::string_view bytes, const std::string& name);
std::string WriteOpenPose(const OpenPoseFrame& frame);

/// An order in which detectors list body keypoints.
struct KeypointLayout {
  std::string name;                 ///< "BODY_25", "BODY_25B", "COCO_17", "COCO_18"
  std::vector<std::string> points;  ///< "nose", "left_shoulder", "mid_hip", ...

  /// -1 when the layout does not have the point.
  int Find(std::string_view point) const;
};

const std::vector<KeypointLayout>& KeypointLayouts();

}  // namespace mocurate
