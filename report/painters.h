#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/motion/clip.h"
#include "core/quality/seen_person.h"
#include "report/drawing.h"
#include "report/filmstrip.h"
#include "report/motion_rows.h"
#include "report/posed_body.h"

namespace mocurate {

/// Pictures drawn with OpenCV: blocks that they are made of, painters of a clip's frames, and pictures of fits as PNG.
/// Colours are blue, green, red. Bodies are drawn with the shape fitted to point clouds, else as capsules with the
/// skeleton's radii, scaled by the person's bone lengths.

/// A drawing on white, 8-bit, `scale` pixels a unit.
cv::Mat ToImage(const Drawing& drawing, double scale);

/// A place in OpenCV's coordinates of four fractional bits.
cv::Point Sixteenths(const Vector2d& at);

/// CV_16UC1; a frame without an image (an empty name) is all 0. Error kMalformed, kNotFound, kInconsistent (other size
/// than the camera).
Expected<cv::Mat> ReadDepth(const DepthView& view, int frame);

/// A point that a view measured, world, metres, and its distance from a body's surface: negative inside.
struct NearPoint {
  Vector3d place;
  double distance;
};
/// Those of every `step`th row and column that are less than `reach` metres outside the body. Errors of ReadDepth.
Expected<std::vector<NearPoint>> PointsNear(const PosedBody& body, const DepthView& view, int frame, int step,
                                            double reach);

Expected<std::string> EncodePng(const cv::Mat& image);

/// Error kInconsistent for a missing motion or frame.
Status CheckFrame(const Clip& fitted, int frame);

/// The views of an evidence that a body can be drawn over: depth views first, then views of keypoints.
int ViewCount(const Evidence& evidence);
const Camera& ViewCamera(const Evidence& evidence, int view);
/// At most `most` of them, evenly chosen.
std::vector<int> ChosenViews(const Evidence& evidence, int most);

/// Painters draw the frames of a clip one after the other with a constant crop. The clip and the evidence must outlive
/// them.

/// The image of one view, cut to the person over `frames`, with the outline and bones of the fitted body over it: depth
/// in false colours, keypoints as dots (those of the person bright, other people's grey).
class ViewPainter {
 public:
  /// `height` pixels of every picture; depth is enlarged by whole factors up to four unless `exact`. Errors
  /// kInconsistent for a missing view or frame, and of ReadDepth.
  static Expected<ViewPainter> Make(const Clip& fitted, const Evidence& evidence, int view,
                                    const std::vector<int>& frames, int height, bool exact);
  Expected<cv::Mat> Draw(int frame) const;

 private:
  Status SetDepthRange(int frame);
  Expected<cv::Mat> Ground(int frame) const;
  void DrawKeypoints(int frame, cv::Mat& image) const;

  const Clip* fitted_ = nullptr;
  const Evidence* evidence_ = nullptr;
  int view_ = 0;
  cv::Rect crop_;
  Camera camera_;  ///< of the pictures
  std::vector<Vector2d> rays_;
  double low_ = 0.0;  ///< of the false colours, in units of the images
  double high_ = 1.0;
};

/// Joint of the skeleton for each keypoint; -1 for points that are not joints.
std::vector<int> JointsOfKeypoints(const Skeleton& skeleton, const std::vector<std::string>& names);

/// The fitted body from its front, the tracked points before it, time below.
class FrontPainter {
 public:
  /// `height` pixels of every picture.
  FrontPainter(const Clip& fitted, const Evidence& evidence, int height);
  cv::Mat Draw(int frame) const;

 private:
  std::vector<MotionRow> rows_;
  int height_;
};

/// The image of a view (depth in false colours, keypoints as dots; depth views come first), cut to the person, with the
/// outline and bones of the fitted body over it; a PNG. Errors kInconsistent when `fitted` has no motion or the frame
/// or view does not exist, kNotFound and kMalformed for depth images.
Expected<std::string> BodyOverlayPng(const Clip& fitted, const Evidence& evidence, int view, int frame);

/// The same as a figure of a page; or a paragraph that says why not.
std::string OverlayHtml(const Clip& fitted, const Evidence& evidence, int view, int frame);

}  // namespace mocurate
