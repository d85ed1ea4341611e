#include "fitting/triangulation/robust_triangulation.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>

#include "core/base/median.h"
#include "fitting/triangulation/normal_equations3.h"

namespace mocurate {
namespace {

constexpr int kMostPairs = 16;                  ///< pairs of views tried, at most (numerical)
constexpr int kRefinements = 4;                 ///< Gauss-Newton steps, at most (numerical)
constexpr double kFullWeightShare = 1.0 / 3.0;  ///< of the outlier limit: up to here a view has almost full weight
constexpr double kOddShare = 0.5;               ///< share of a camera's detections excluded, and
constexpr double kOddRatio = 4.0;               ///< ratio to any other camera, that together exclude it

using Rays = std::vector<ViewRay>;

/// A point in the camera of a ray, and its pixel error with the lens distortion taken off on both sides.
struct Seen {
  Vector3d in_camera;
  Vector2d error;  ///< px; not finite behind the camera

  [[gnu::always_inline]] Seen(const ViewRay& ray, const Vector3d& point)
      : in_camera(ray.view->rotation * (point - ray.view->centre)) {
    const Camera& camera = ray.view->camera;
    const double inverse = 1.0 / in_camera.z();
    error.x() = camera.fx * (in_camera.x() * inverse - ray.normalised.x());
    error.y() = camera.fy * (in_camera.y() * inverse - ray.normalised.y());
  }
  bool behind() const { return !(in_camera.z() > 0.0); }
  double square() const { return behind() ? kBehind_px * kBehind_px : error.squaredNorm(); }
  /// Adds weight * |error|^2 / 2, linearised in the point.
  [[gnu::always_inline]] void AddTo(NormalEquations3& equations, double weight, const ViewRay& ray) const {
    const Camera& camera = ray.view->camera;
    const Matrix3d& rotation = ray.view->rotation;
    const double inverse = 1.0 / in_camera.z();
    const Vector3d along = inverse * rotation.row(2).transpose();
    equations.Add(weight, camera.fx * (inverse * rotation.row(0).transpose() - in_camera.x() * inverse * along),
                  error.x());
    equations.Add(weight, camera.fy * (inverse * rotation.row(1).transpose() - in_camera.y() * inverse * along),
                  error.y());
  }
};

double SquaredError(const ViewRay& ray, const Vector3d& point) { return Seen(ray, point).square(); }

/// Minimises the weighted squares of the distances from some rays.
template <typename RaysToMeet>
Vector3d NearestPoint(const RaysToMeet& rays) {
  NormalEquations3 equations;
  for (const ViewRay& ray : rays) equations.AddAcross(ray.weight, ray.direction, ray.view->centre);
  Vector3d point = Vector3d::Constant(std::nan(""));
  equations.Solve(point);
  return point;
}

bool Parallel(const ViewRay& a, const ViewRay& b) { return a.direction.cross(b.direction).norm() < kParallelRays; }

bool AllParallel(const Rays& rays) {
  for (std::size_t i = 1; i < rays.size(); ++i) {
    if (!Parallel(rays[0], rays[i])) return false;
  }
  return true;
}

/// Gauss-Newton on pixel errors under the loss of Geman and McClure, which gives outliers almost no weight.
struct Refined {
  Vector3d point = Vector3d::Zero();
  bool solved = false;
};

Refined RefinePoint(const Rays& rays, const Vector3d& start, double scale, double noise) {
  Refined refined;
  refined.point = start;
  for (int i = 0; i < kRefinements; ++i) {
    NormalEquations3 equations;
    for (const ViewRay& ray : rays) {
      const Seen seen(ray, refined.point);
      if (seen.behind()) continue;
      const double trust = 1.0 / (1.0 + seen.square() / (scale * scale));
      seen.AddTo(equations, ray.weight * trust * trust / (noise * noise), ray);
    }
    Vector3d step;
    if (!equations.Solve(step)) return refined;
    refined.point -= step;
    refined.solved = refined.point.allFinite();
    if (!refined.solved || step.squaredNorm() < 1e-12) return refined;
  }
  return refined;
}

/// Loss of Geman and McClure of the pixel errors, by confidence.
double Score(const Rays& rays, const Vector3d& point, double scale) {
  double score = 0.0;
  for (const ViewRay& ray : rays) {
    const double square = SquaredError(ray, point) / (scale * scale);
    score += ray.weight * square / (1.0 + square);
  }
  return score;
}

/// Best of a point and those of pairs of rays, distributed evenly over all pairs.
Vector3d BestPoint(const Rays& rays, const Vector3d& first, double scale) {
  Vector3d best = first;
  double best_score = Score(rays, first, scale);
  const auto try_pair = [&](std::size_t a, std::size_t b) {
    if (Parallel(rays[a], rays[b])) return;
    const Vector3d point = NearestPoint(std::array<std::reference_wrapper<const ViewRay>, 2>{rays[a], rays[b]});
    const double score = Score(rays, point, scale);
    if (score >= best_score) return;
    best = point;
    best_score = score;
  };
  const std::size_t count = rays.size();
  const std::size_t pairs = count * (count - 1) / 2;
  if (pairs <= kMostPairs) {
    for (std::size_t a = 0; a < count; ++a) {
      for (std::size_t b = a + 1; b < count; ++b) try_pair(a, b);
    }
    return best;
  }
  for (std::size_t i = 0; i < kMostPairs; ++i) {
    const std::size_t a = i * count / kMostPairs;
    const std::size_t reach = 1 + i * (count / 2) / kMostPairs;  // neighbours first, opposite views last
    try_pair(a, (a + reach) % count);
  }
  return best;
}

bool AllWithin(const Rays& rays, const Vector3d& point, double limit) {
  return std::all_of(rays.begin(), rays.end(),
                     [&](const ViewRay& ray) { return SquaredError(ray, point) <= limit * limit; });
}

/// Point, and the rays that agree with it; empty with too few.
std::optional<TriangulatedPoint> JudgePoint(const Rays& rays, const Refined& refined,
                                            const TriangulationOptions& options) {
  if (!refined.solved) return {};
  TriangulatedPoint point;
  point.position = refined.point;
  NormalEquations3 equations;
  const ViewRay* first = nullptr;
  bool parallel = true;
  for (const ViewRay& ray : rays) {
    const Seen seen(ray, point.position);
    const double square = seen.square();
    if (square > options.outlier * options.outlier) continue;
    if (first == nullptr) first = &ray;
    parallel = parallel && Parallel(*first, ray);
    ++point.view_count;
    seen.AddTo(equations, ray.weight / (options.noise * options.noise), ray);
    point.error_px += std::sqrt(square);
    if (ray.index < 64) point.views |= std::uint64_t{1} << static_cast<unsigned>(ray.index);
  }
  const bool most = 2 * static_cast<std::size_t>(point.view_count) > rays.size();
  if (point.view_count < options.min_views || !most || parallel) return {};
  point.error_px /= point.view_count;
  point.covariance = equations.Matrix().inverse();
  return point;
}

/// Precision relative to the median of the take; 1 at most.
void ConfidenceOfPrecision(std::vector<double>& sigma) {
  std::vector<double> found;
  std::copy_if(sigma.begin(), sigma.end(), std::back_inserter(found), [](double value) { return value > 0.0; });
  const double median = MeanMedian(found);
  for (double& value : sigma) value = value > 0.0 ? std::min(median / value, 1.0) : 0.0;
}

/// Covariance relative to the median variance per axis; the identity without a point (confidence 0).
std::vector<Matrix3d> RelativePrecision(const std::vector<Matrix3d>& covariance,
                                        const std::vector<double>& confidence) {
  std::vector<double> variance;
  for (std::size_t i = 0; i < covariance.size(); ++i) {
    if (confidence[i] > 0.0) variance.push_back(covariance[i].trace() / 3.0);
  }
  const double typical = MeanMedian(variance);
  std::vector<Matrix3d> precision(covariance.size(), Matrix3d::Identity());
  for (std::size_t i = 0; i < covariance.size(); ++i) {
    if (confidence[i] > 0.0) precision[i] = typical * covariance[i].inverse();
  }
  return precision;
}

void NameOddCameras(std::vector<CameraAgreement>& cameras) {
  for (std::size_t v = 0; v < cameras.size(); ++v) {
    const double share = cameras[v].excluded_share();
    cameras[v].disagrees =
        cameras.size() > 2 && share > kOddShare && share > kOddRatio * LargestExcludedShare(cameras, v);
  }
}

}  // namespace

double LargestExcludedShare(const std::vector<CameraAgreement>& cameras, std::size_t own) {
  double most = 0.0;
  for (std::size_t v = 0; v < cameras.size(); ++v) {
    if (v != own) most = std::max(most, cameras[v].excluded_share());
  }
  return most;
}

TriangulationView::TriangulationView(const Camera& calibrated)
    : camera(calibrated),
      rotation(calibrated.camera_from_world.rotation.toRotationMatrix()),
      centre(calibrated.Centre()) {}

ViewRay::ViewRay(const TriangulationView& seen_by, int view_index, const Vector2d& at_depth_1, double confidence)
    : view(&seen_by),
      index(view_index),
      direction((seen_by.rotation.transpose() * Vector3d(at_depth_1.x(), at_depth_1.y(), 1.0)).normalized()),
      normalised(at_depth_1),
      weight(confidence) {}

std::optional<TriangulatedPoint> TriangulateRobust(const std::vector<ViewRay>& rays,
                                                   const TriangulationOptions& options) {
  if (static_cast<std::int64_t>(rays.size()) < std::max<std::int64_t>(options.min_views, 2) || AllParallel(rays))
    return {};
  const Vector3d nearest = NearestPoint(rays);
  const double scale = kFullWeightShare * options.outlier;
  const Refined all = RefinePoint(rays, nearest, scale, options.noise);
  if (all.solved && AllWithin(rays, all.point, scale)) return JudgePoint(rays, all, options);
  const Vector3d start = BestPoint(rays, all.solved ? all.point : nearest, scale);
  const Refined best = RefinePoint(rays, start, scale, options.noise);
  auto point = JudgePoint(rays, best, options);
  if (point || !best.solved) return point;
  return JudgePoint(rays, RefinePoint(rays, best.point, options.outlier, options.noise),
                    options);  // views that agree less well
}

TriangulatedTracks TriangulateViews(const std::vector<ViewKeypoints>& views, int frames, int keypoints,
                                    const TriangulationOptions& options) {
  const std::size_t count = static_cast<std::size_t>(frames) * keypoints;
  TriangulatedTracks tracks;
  tracks.positions = JointPositions(frames, keypoints);
  tracks.confidence.assign(count, 0.0);
  tracks.view_count.assign(count, 0);
  tracks.error_px.assign(count, 0.0);
  std::vector<Matrix3d> covariance(count, Matrix3d::Zero());
  tracks.cameras.resize(views.size());
  std::vector<TriangulationView> prepared;
  for (const ViewKeypoints& view : views) prepared.emplace_back(view.camera);
  std::vector<std::vector<double>> errors(views.size());
  Rays rays;
  for (std::size_t i = 0; i < count; ++i) {
    rays.clear();
    for (std::size_t v = 0; v < views.size(); ++v) {
      const double confidence = views[v].confidence[i];
      if (confidence <= 0.0 || confidence < options.min_confidence) continue;
      rays.emplace_back(prepared[v], static_cast<int>(v), views[v].normalised[i], confidence);
    }
    const auto point = TriangulateRobust(rays, options);
    if (!point) continue;
    const auto frame = static_cast<int>(i / static_cast<std::size_t>(keypoints));
    tracks.positions.at(frame, static_cast<int>(i % static_cast<std::size_t>(keypoints))) = point->position;
    tracks.confidence[i] = std::sqrt(point->covariance.trace());
    tracks.view_count[i] = point->view_count;
    tracks.error_px[i] = point->error_px;
    covariance[i] = point->covariance;
    for (const ViewRay& ray : rays) {
      const double error = std::sqrt(SquaredError(ray, point->position));
      errors[ray.index].push_back(error);
      ++tracks.cameras[ray.index].detections;
      tracks.cameras[ray.index].excluded += error > options.outlier ? 1 : 0;
    }
  }
  for (std::size_t v = 0; v < views.size(); ++v) tracks.cameras[v].median_px = MeanMedian(errors[v]);
  tracks.precision = RelativePrecision(covariance, tracks.confidence);
  ConfidenceOfPrecision(tracks.confidence);
  NameOddCameras(tracks.cameras);
  return tracks;
}

}  // namespace mocurate
