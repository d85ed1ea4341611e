#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/geometry/camera.h"
#include "core/motion/motion.h"
#include "fitting/options.h"

namespace mocurate {

inline constexpr double kBehind_px = 1e6;  ///< error of a point that is not in front of the camera (numerical)

/// A camera with precomputed values for triangulation.
struct TriangulationView {
  explicit TriangulationView(const Camera& calibrated);

  Camera camera;
  Matrix3d rotation;  ///< camera_from_world
  Vector3d centre;    ///< of projection, world, metres
};

/// Observation of a point by one view: a ray in the world, and a pixel error.
struct ViewRay {
  const TriangulationView* view = nullptr;
  int index = 0;                           ///< of the view
  Vector3d direction = Vector3d::UnitZ();  ///< world, unit length
  Vector2d normalised = Vector2d::Zero();  ///< at depth 1, without lens distortion
  double weight = 1.0;                     ///< confidence: information relative to a detection of confidence 1

  /// Of a detection at depth 1 whose lens distortion is undone.
  ViewRay(const TriangulationView& seen_by, int view_index, const Vector2d& at_depth_1, double confidence);
};

struct TriangulatedPoint {
  Vector3d position = Vector3d::Zero();    ///< world, metres
  Matrix3d covariance = Matrix3d::Zero();  ///< m^2, of detections with the stated noise over their confidence
  std::uint64_t views = 0;                 ///< bit v: view v agrees (views beyond 63 are counted, not marked)
  int view_count = 0;
  double error_px = 0.0;  ///< mean over the agreeing views
};

/// The point that most rays agree on: least squares of pixel errors under the loss of Geman and McClure (scale a third
/// of options.outlier), Gauss-Newton from all rays. Where an error exceeds that scale, also from points of pairs of
/// rays, the best by the same loss (at most 16 pairs, distributed over the views, so that time grows linearly with
/// their number). Empty when fewer than min_views or not a majority of the views agree, or their rays are parallel to
/// within 1 degree.
std::optional<TriangulatedPoint> TriangulateRobust(const std::vector<ViewRay>& rays,
                                                   const TriangulationOptions& options);

/// Detections of one person's K keypoints in one camera over F frames; confidence 0: missed, the point is not read.
struct ViewKeypoints {
  Camera camera;
  std::vector<double> confidence;    ///< (F*K) in [0, 1]
  std::vector<Vector2d> normalised;  ///< (F*K) at depth 1 without lens distortion
};

/// Agreement of a camera with the others.
struct CameraAgreement {
  int detections = 0;      ///< of a triangulated point
  int excluded = 0;        ///< of them beyond the limit
  double median_px = 0.0;  ///< median distance of all of them from the point that the agreeing views gave
  bool disagrees = false;  ///< most are excluded, at least four times the share of the other cameras

  double excluded_share() const { return detections > 0 ? static_cast<double>(excluded) / detections : 0.0; }
};

/// The largest share of excluded detections of any camera but `own`.
double LargestExcludedShare(const std::vector<CameraAgreement>& cameras, std::size_t own);

struct TriangulatedTracks {
  JointPositions positions;         ///< (F,K,3) world; 0 without a point
  std::vector<double> confidence;   ///< (F*K) 0 without a point; 1 for the median precision of the take, less for worse
  std::vector<int> view_count;      ///< (F*K)
  std::vector<double> error_px;     ///< (F*K) mean over the agreeing views
  std::vector<Matrix3d> precision;  ///< (F*K) inverse of the covariance, over the take's median precision per axis
  std::vector<CameraAgreement> cameras;
};

/// Every keypoint of every frame. All views have F*K entries.
TriangulatedTracks TriangulateViews(const std::vector<ViewKeypoints>& views, int frames, int keypoints,
                                    const TriangulationOptions& options);

}  // namespace mocurate
