#include "fitting/triangulation/robust_triangulation.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "fitting/evidence/noise.h"

namespace mocurate {
namespace {

constexpr double kParallelRays = 0.0175;  ///< sine of the smallest angle between rays, 1 degree
constexpr int kMostPairs = 16;
constexpr int kRefinements = 4;
constexpr double kTrust = 1.0 / 3.0;  ///< of the outlier limit: up to here a view counts almost fully
constexpr double kBehind = 1e6;       ///< px; error of a point that is not in front
constexpr double kOddShare = 0.5;
constexpr double kOddRatio = 4.0;

using Rays = std::vector<ViewRay>;

/// A point in the camera of a ray, and its pixel error with the lens distortion taken off on both sides.
struct Seen {
  Vector3d in_camera;
  Vector2d error;  ///< px; no number behind the camera

  Seen(const ViewRay& ray, const Vector3d& point) : in_camera(ray.view->rotation * (point - ray.view->centre)) {
    const Camera& camera = ray.view->camera;
    error.x() = camera.fx * (in_camera.x() / in_camera.z() - ray.normalised.x());
    error.y() = camera.fy * (in_camera.y() / in_camera.z() - ray.normalised.y());
  }
  double length() const { return in_camera.z() > 0.0 ? error.norm() : kBehind; }
  /// d error / d point.
  Eigen::Matrix<double, 2, 3> Slope(const ViewRay& ray) const {
    const Camera& camera = ray.view->camera;
    const double inverse = 1.0 / in_camera.z();
    Eigen::Matrix<double, 2, 3> slope;
    slope.row(0) =
        camera.fx * inverse * (ray.view->rotation.row(0) - in_camera.x() * inverse * ray.view->rotation.row(2));
    slope.row(1) =
        camera.fy * inverse * (ray.view->rotation.row(1) - in_camera.y() * inverse * ray.view->rotation.row(2));
    return slope;
  }
};

double ErrorLength(const ViewRay& ray, const Vector3d& point) { return Seen(ray, point).length(); }

/// Nearest point to some rays: minimises the weighted squares of the distances from them.
class NearestPoint {
 public:
  void Add(const ViewRay& ray) {
    const Matrix3d across = ray.weight * (Matrix3d::Identity() - ray.direction * ray.direction.transpose());
    sum_ += across;
    right_ += across * ray.view->centre;
  }
  Vector3d Solve() const { return sum_.ldlt().solve(right_); }

 private:
  Matrix3d sum_ = Matrix3d::Zero();
  Vector3d right_ = Vector3d::Zero();
};

bool Parallel(const ViewRay& a, const ViewRay& b) { return a.direction.cross(b.direction).norm() < kParallelRays; }

bool AllParallel(const Rays& rays) {
  for (std::size_t i = 1; i < rays.size(); ++i) {
    if (!Parallel(rays[0], rays[i])) return false;
  }
  return true;
}

/// Gauss-Newton on pixel errors under the loss of Geman and McClure, which a far view hardly pulls at.
struct Refined {
  Vector3d point = Vector3d::Zero();
  bool solved = false;
};

Refined RefinePoint(const Rays& rays, const Vector3d& start, double scale, double noise) {
  Refined refined;
  refined.point = start;
  for (int i = 0; i < kRefinements; ++i) {
    Matrix3d information = Matrix3d::Zero();
    Vector3d pull = Vector3d::Zero();
    for (const ViewRay& ray : rays) {
      const Seen seen(ray, refined.point);
      const double length = seen.length();
      if (length == kBehind) continue;
      const Eigen::Matrix<double, 2, 3> slope = seen.Slope(ray);
      const double trust = 1.0 / (1.0 + length * length / (scale * scale));
      const double weight = ray.weight * ray.weight / (noise * noise) * trust * trust;
      information.noalias() += weight * slope.transpose() * slope;
      pull.noalias() += weight * slope.transpose() * seen.error;
    }
    const Eigen::LLT<Matrix3d> factor(information);
    if (factor.info() != Eigen::Success) return refined;
    const Vector3d step = factor.solve(pull);
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
    const double error = ErrorLength(ray, point) / scale;
    score += ray.weight * error * error / (1.0 + error * error);
  }
  return score;
}

/// Best of a point and those of pairs of rays, spread evenly over all pairs.
Vector3d BestPoint(const Rays& rays, const Vector3d& first, double scale) {
  Vector3d best = first;
  double best_score = Score(rays, first, scale);
  const auto try_pair = [&](std::size_t a, std::size_t b) {
    if (Parallel(rays[a], rays[b])) return;
    NearestPoint nearest;
    nearest.Add(rays[a]);
    nearest.Add(rays[b]);
    const Vector3d point = nearest.Solve();
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
  return std::all_of(rays.begin(), rays.end(), [&](const ViewRay& ray) { return ErrorLength(ray, point) <= limit; });
}

/// Point, and which rays agree with it; empty when too few do.
std::optional<TriangulatedPoint> JudgePoint(const Rays& rays, const Refined& refined,
                                            const TriangulationOptions& options) {
  if (!refined.solved) return {};
  TriangulatedPoint point;
  point.position = refined.point;
  Rays agreeing;
  Matrix3d information = Matrix3d::Zero();
  for (const ViewRay& ray : rays) {
    const Seen seen(ray, point.position);
    const double error = seen.length();
    if (error > options.outlier) continue;
    agreeing.push_back(ray);
    const Eigen::Matrix<double, 2, 3> slope = ray.weight / options.noise * seen.Slope(ray);
    information.noalias() += slope.transpose() * slope;
    point.error_px += error;
    if (ray.index < 64) point.views |= std::uint64_t{1} << static_cast<unsigned>(ray.index);
  }
  point.view_count = static_cast<int>(agreeing.size());
  if (point.view_count < options.min_views || 2 * agreeing.size() <= rays.size() || AllParallel(agreeing)) return {};
  point.error_px /= point.view_count;
  point.covariance = information.inverse();
  return point;
}

/// Each precision against the median of the take; 1 at most.
void ConfidenceOfPrecision(std::vector<double>& sigma) {
  std::vector<double> found;
  std::copy_if(sigma.begin(), sigma.end(), std::back_inserter(found), [](double value) { return value > 0.0; });
  const double median = Median(found);
  for (double& value : sigma) value = value > 0.0 ? std::min(median / value, 1.0) : 0.0;
}

/// Of each point against the median variance per axis; the identity where none is found (confidence 0).
std::vector<Matrix3d> RelativePrecision(const std::vector<Matrix3d>& covariance,
                                        const std::vector<double>& confidence) {
  std::vector<double> variance;
  for (std::size_t i = 0; i < covariance.size(); ++i) {
    if (confidence[i] > 0.0) variance.push_back(covariance[i].trace() / 3.0);
  }
  const double typical = Median(variance);
  std::vector<Matrix3d> precision(covariance.size(), Matrix3d::Identity());
  for (std::size_t i = 0; i < covariance.size(); ++i) {
    if (confidence[i] > 0.0) precision[i] = typical * covariance[i].inverse();
  }
  return precision;
}

void NameTheOddOnes(std::vector<CameraAgreement>& cameras) {
  const auto share = [](const CameraAgreement& camera) {
    return camera.detections > 0 ? static_cast<double>(camera.left_out) / camera.detections : 0.0;
  };
  for (CameraAgreement& camera : cameras) {
    double others = 0.0;
    for (const CameraAgreement& other : cameras) {
      if (&other != &camera) others = std::max(others, share(other));
    }
    camera.disagrees = cameras.size() > 2 && share(camera) > kOddShare && share(camera) > kOddRatio * others;
  }
}

}  // namespace

TriangulationView::TriangulationView(const Camera& calibrated)
    : camera(calibrated),
      rotation(calibrated.camera_from_world.rotation.toRotationMatrix()),
      centre(calibrated.Centre()) {}

ViewRay::ViewRay(const TriangulationView& seen_by, int view_index, const Vector2d& pixel, double confidence)
    : view(&seen_by), index(view_index), weight(confidence) {
  const Vector3d seen = seen_by.camera.Unproject(pixel, 1.0);
  normalised = seen.head<2>();
  direction = (seen_by.rotation.transpose() * seen).normalized();
}

ViewRay ViewRay::Undistorted(const TriangulationView& seen_by, int view_index, const Vector2d& normalised,
                             double confidence) {
  ViewRay ray;
  ray.view = &seen_by;
  ray.index = view_index;
  ray.normalised = normalised;
  ray.direction = (seen_by.rotation.transpose() * Vector3d(normalised.x(), normalised.y(), 1.0)).normalized();
  ray.weight = confidence;
  return ray;
}

std::optional<TriangulatedPoint> TriangulateRobust(const std::vector<ViewRay>& rays,
                                                   const TriangulationOptions& options) {
  if (static_cast<std::int64_t>(rays.size()) < std::max<std::int64_t>(options.min_views, 2) || AllParallel(rays))
    return {};
  NearestPoint nearest;
  for (const ViewRay& ray : rays) nearest.Add(ray);
  const double scale = kTrust * options.outlier;
  const Refined all = RefinePoint(rays, nearest.Solve(), scale, options.noise);
  if (all.solved && AllWithin(rays, all.point, scale)) return JudgePoint(rays, all, options);
  const Vector3d start = BestPoint(rays, all.solved ? all.point : nearest.Solve(), scale);
  const Refined best = RefinePoint(rays, start, scale, options.noise);
  const auto point = JudgePoint(rays, best, options);
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
      const auto index = static_cast<int>(v);
      if (views[v].normalised.empty()) {
        rays.emplace_back(prepared[v], index, views[v].pixel[i], confidence);
      } else {
        rays.push_back(ViewRay::Undistorted(prepared[v], index, views[v].normalised[i], confidence));
      }
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
      const double error = ErrorLength(ray, point->position);
      errors[ray.index].push_back(error);
      ++tracks.cameras[ray.index].detections;
      tracks.cameras[ray.index].left_out += error > options.outlier ? 1 : 0;
    }
  }
  for (std::size_t v = 0; v < views.size(); ++v) tracks.cameras[v].median_px = Median(errors[v]);
  tracks.precision = RelativePrecision(covariance, tracks.confidence);
  ConfidenceOfPrecision(tracks.confidence);
  NameTheOddOnes(tracks.cameras);
  return tracks;
}

}  // namespace mocurate
