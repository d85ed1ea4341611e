#pragma once

#include <string>
#include <vector>

#include "core/base/finding.h"
#include "report/filmstrip.h"
#include "report/options.h"

namespace mocurate {

/// A bone's length over time, in the evidence and in the fit. Millimetres.
struct BoneSeries {
  int joint = 0;               ///< the bone that ends there
  std::vector<double> raw;     ///< (F) NaN where an end was not observed
  double raw_mean = 0.0;       ///< over the frames that have it
  double raw_spread = 0.0;     ///< standard deviation over them
  std::vector<double> fitted;  ///< (F)
  double fitted_spread = 0.0;
};

/// A fit and its evidence, frame by frame. F frames; NaN where a frame has no value.
struct ClipSeries {
  std::vector<double> time_s;
  std::string residual_name;              ///< description of the residual, with its unit
  std::vector<double> residual;           ///< (F) root mean square, or for depth and keypoints the median
  std::vector<double> residual_most;      ///< (F) of the worst joint; empty for depth and keypoints
  std::string keypoint_residual_name;     ///< for keypoints beside depth views; empty: not both
  std::vector<double> keypoint_residual;  ///< (F)
  std::vector<double> jerk_raw;           ///< (F) m/s^3, root mean square over joints; empty without tracks
  std::vector<double> jerk_fitted;        ///< (F)
  std::vector<BoneSeries> bones;          ///< bones of the evidence, else all
  bool raw_bones = false;                 ///< whether the evidence has any
  std::vector<double> sigma_mm;  ///< (F) estimated standard deviation of a joint position per axis, root mean square
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

/// One clip before and after its fit: video, filmstrips, player, residual and jerk, bone lengths, corrections, states,
/// uncertainty, and the body over every view. Self-contained except for the video beside it. Error kInconsistent
/// without a motion.
Expected<std::string> MakeClipPage(const ClipPageInput& input);

}  // namespace mocurate
