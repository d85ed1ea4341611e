#pragma once

#include <string>
#include <vector>

#include "core/base/finding.h"
#include "report/filmstrip.h"
#include "report/options.h"

namespace mocurate {

/// Tracks in the order of a skeleton's joints; a confidence is 1, or 0 where a joint was not observed.
struct TracksOfJoints {
  JointPositions joints;           ///< (F,J,3) world, metres
  std::vector<double> confidence;  ///< (F,J)
};
TracksOfJoints InJoints(const JointTracks& tracks, const Skeleton& skeleton);

/// Distance of a fit from its evidence, frame by frame. F frames; NaN where a frame has no value.
struct ClipSeries {
  std::string residual_name;              ///< description of the residual, with its unit
  std::vector<double> residual;           ///< (F) root mean square, or for depth and keypoints the median
  std::vector<double> residual_most;      ///< (F) of the worst joint; empty for depth and keypoints
  std::string keypoint_residual_name;     ///< for keypoints beside depth views; empty: not both
  std::vector<double> keypoint_residual;  ///< (F)
};

/// Error kInconsistent when the clip has no motion. Frames of unreadable views have no residual.
Expected<ClipSeries> SeriesOf(const Clip& fitted, const Evidence& evidence);

/// Estimated standard deviation of a joint position per axis in a frame, millimetres; NaN where the fit has none.
double StatedSigmaMm(const Motion& motion, int frame, int joint);

/// Input of a page about one clip.
struct ClipPageInput {
  DrawnClip clip;                 ///< with a fitted motion
  std::vector<Finding> findings;  ///< of ingest and fit, stored with the fit
  ClipPageOptions options;
};

/// One clip before and after its fit: video, filmstrips, viewer, residual, bone lengths, corrections, uncertainty, and
/// the body over every view. Self-contained except for the video beside it. Error kInconsistent without a motion.
Expected<std::string> MakeClipPage(const ClipPageInput& input);

}  // namespace mocurate
