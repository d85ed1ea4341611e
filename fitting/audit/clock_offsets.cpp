#include "fitting/audit/clock_offsets.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/base/median.h"

namespace mocurate {
namespace {

/// Factor on a third of the outlier limit: scale of the loss in each iteration (numerical).
constexpr std::array<double, 8> kScales = {6.0, 4.0, 3.0, 2.0, 1.0, 1.0, 1.0, 1.0};
/// Standard deviation of the prior that regularises undetermined offsets (numerical).
constexpr double kWeakPrior_s = 1.0;
constexpr double kUndetermined_s = 0.2;  ///< standard deviation from which an offset counts as
                                         ///< undetermined
constexpr double kJump_px = 60.0;    ///< distance of the middle detection from the line through its neighbours: beyond,
                                     ///< one of the three is an outlier
constexpr double kSettled_s = 2e-4;  ///< change of an offset that ends the iterations (numerical)
constexpr std::size_t kFewestViewsToDrop = 4;  ///< fewest views for ChangeOfClocks: three must remain (numerical)

/// d pixel error / d point, px per metre.
Eigen::Matrix<double, 2, 3> SlopeOf(const Camera& camera, const Matrix3d& rotation, const Vector3d& point) {
  const Vector3d at = camera.camera_from_world * point;
  Eigen::Matrix<double, 2, 3> slope;
  slope.row(0) = camera.fx / at.z() * (rotation.row(0) - at.x() / at.z() * rotation.row(2));
  slope.row(1) = camera.fy / at.z() * (rotation.row(1) - at.y() / at.z() * rotation.row(2));
  return slope;
}

/// Normal equations of the clock offsets over some moments.
struct ClockEquations {
  Eigen::MatrixXd information;
  Eigen::VectorXd gradient;
  std::vector<Eigen::VectorXd> of_moment;  ///< gradients
  Eigen::VectorXd by_noise;                ///< variance that noise of the velocities adds to the information's diagonal
};

/// Pixels per second of each detection, by central differences over two of the view's frames. (M*K)
std::vector<Vector2d> Velocities(const RigSamples& samples, const RigModel& model, std::size_t view, std::size_t part,
                                 const ViewKeypoints& now) {
  const double reach = 2.0 * samples.Step(view);
  const ViewKeypoints before = samples.View(model, view, part, -reach);
  const ViewKeypoints after = samples.View(model, view, part, reach);
  std::vector<Vector2d> velocity(before.confidence.size(), Vector2d::Zero());
  for (std::size_t i = 0; i < velocity.size() && reach > 0.0; ++i) {
    if (before.confidence[i] <= 0.0 || after.confidence[i] <= 0.0) continue;
    const Vector2d off = before.normalised[i] + after.normalised[i] - 2.0 * now.normalised[i];
    if (now.confidence[i] <= 0.0 || before.camera.fx * off.norm() > kJump_px) continue;
    const Vector2d moved = (after.normalised[i] - before.normalised[i]) / (2.0 * reach);
    velocity[i] = {before.camera.fx * moved.x(), before.camera.fy * moved.y()};
  }
  return velocity;
}

ClockEquations Linearise(const RigSamples& samples, const RigModel& model, const TriangulationOptions& options,
                         double scale) {
  std::vector<std::size_t> view_of;
  const std::vector<ViewKeypoints> views = samples.Views(model, &view_of);
  TriangulationOptions wide = options;
  wide.outlier = std::max(options.outlier, 3.0 * scale);
  const TriangulatedTracks points = TriangulateViews(views, samples.count(), samples.keypoints(), wide);
  std::vector<std::vector<Vector2d>> velocity;
  std::vector<Matrix3d> rotation;
  for (std::size_t i = 0, part = 0; i < views.size(); ++i) {
    part = i > 0 && view_of[i] == view_of[i - 1] ? part + 1 : 0;
    velocity.push_back(Velocities(samples, model, view_of[i], part, views[i]));
    rotation.push_back(views[i].camera.camera_from_world.rotation.toRotationMatrix());
  }
  const auto n = static_cast<Eigen::Index>(samples.views());
  ClockEquations equations{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), {}, Eigen::VectorXd::Zero(n)};
  const auto keypoints = static_cast<std::size_t>(samples.keypoints());
  for (int m = 0; m < samples.count(); ++m) {
    Eigen::VectorXd of_moment = Eigen::VectorXd::Zero(n);
    for (std::size_t at = m * keypoints; at < (m + 1) * keypoints; ++at) {
      if (points.confidence[at] <= 0.0) continue;
      const Eigen::Map<const Vector3d> point(points.positions.xyz.data() + 3 * at);
      Matrix3d own = Matrix3d::Zero();
      Vector3d pull = Vector3d::Zero();
      Eigen::Matrix3Xd cross = Eigen::Matrix3Xd::Zero(3, n);
      Eigen::VectorXd square = Eigen::VectorXd::Zero(n);
      Eigen::VectorXd slope_of_clock = Eigen::VectorXd::Zero(n);
      for (std::size_t v = 0; v < views.size(); ++v) {
        if (views[v].confidence[at] <= 0.0) continue;
        const Vector2d error = PixelError(views[v], at, point);
        const double robust = 1.0 / (1.0 + error.squaredNorm() / (scale * scale));
        const double weight = views[v].confidence[at] * robust * robust / (options.noise * options.noise);
        const auto slope = SlopeOf(views[v].camera, rotation[v], point);
        const Vector2d& speed = velocity[v][at];  // a later clock reads an earlier stamp: d error / d clock
        const auto view = static_cast<Eigen::Index>(view_of[v]);
        own += weight * slope.transpose() * slope;
        pull += weight * slope.transpose() * error;
        cross.col(view) += weight * slope.transpose() * speed;
        square[view] += weight * speed.squaredNorm();
        slope_of_clock[view] += weight * speed.dot(error);
      }
      const Eigen::LLT<Matrix3d> factor(own);
      if (factor.info() != Eigen::Success) continue;
      const Eigen::Matrix3Xd through = factor.solve(cross);
      for (std::size_t v = 0; v < views.size(); ++v) {
        if (views[v].confidence[at] <= 0.0) continue;
        const double robust = 1.0 / (1.0 + PixelError(views[v], at, point).squaredNorm() / (scale * scale));
        const double weight = views[v].confidence[at] * robust * robust / (options.noise * options.noise);
        const auto slope = SlopeOf(views[v].camera, rotation[v], point);
        const double leverage = weight * (slope * factor.solve(slope.transpose())).trace();
        const double reach = 4.0 * samples.Step(view_of[v]);
        const double variance = 2.0 * options.noise * options.noise / (views[v].confidence[at] * reach * reach);
        equations.by_noise[static_cast<Eigen::Index>(view_of[v])] += weight * variance * (2.0 - leverage);
      }
      equations.information.diagonal() += square;
      equations.information.noalias() -= cross.transpose() * through;
      of_moment += slope_of_clock - through.transpose() * pull;
    }
    equations.gradient += of_moment;
    equations.of_moment.push_back(std::move(of_moment));
  }
  return equations;
}

/// Variances of `solve` * the sum of the gradients, from sums over spans of the take. Spans grow from single moments
/// on, so that their errors are less dependent; the largest variance counts.
Eigen::VectorXd VarianceBySpans(const std::vector<Eigen::VectorXd>& gradients, const Eigen::MatrixXd& solve) {
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(solve.rows());
  std::size_t spans = gradients.size();
  do {
    Eigen::VectorXd of_spans = Eigen::VectorXd::Zero(solve.rows());
    for (std::size_t s = 0; s < spans; ++s) {
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(solve.cols());
      const std::size_t end = (s + 1) * gradients.size() / spans;
      for (std::size_t i = s * gradients.size() / spans; i < end; ++i) sum += gradients[i];
      of_spans += (solve * sum).cwiseAbs2();
    }
    const auto count = static_cast<double>(spans);
    variance = variance.cwiseMax(of_spans * count / (count - 1.0));
    spans = 2 * spans / 3;
  } while (spans >= kFewestSpans);
  return variance;
}

/// The camera to whose clock the most others agree; ties: the first.
std::size_t CommonClock(const ClockOffsets& offsets) {
  std::size_t best = 0;
  int most = -1;
  for (std::size_t v = 0; v < offsets.clock_s.size(); ++v) {
    if (!std::isfinite(offsets.sigma_s[v])) continue;
    int along = 0;
    for (std::size_t w = 0; w < offsets.clock_s.size(); ++w) {
      const double near = std::max(kSameClock_s, 3.0 * std::hypot(offsets.sigma_s[v], offsets.sigma_s[w]));
      along += std::isfinite(near) && std::abs(offsets.clock_s[v] - offsets.clock_s[w]) <= near ? 1 : 0;
    }
    if (along <= most) continue;
    most = along;
    best = v;
  }
  return best;
}

}  // namespace

ClockOffsets RefineClocks(const RigSamples& samples, const RigModel& model, const TriangulationOptions& options) {
  const auto n = static_cast<Eigen::Index>(samples.views());
  RigModel at = model;
  ClockEquations equations;
  const Eigen::MatrixXd prior = Eigen::MatrixXd::Identity(n, n) / (kWeakPrior_s * kWeakPrior_s);
  for (const double scale : kScales) {
    equations = Linearise(samples, at, options, scale * options.outlier / 3.0);
    const Eigen::VectorXd step = -(equations.information + prior).ldlt().solve(equations.gradient);
    if (!step.allFinite()) break;
    const double longest = step.cwiseAbs().maxCoeff();
    const double allowed = longest > 0.1 ? 0.1 / longest : 1.0;
    for (Eigen::Index v = 0; v < n; ++v) at.clock_s[static_cast<std::size_t>(v)] += allowed * step[v];
    if (scale <= 1.0 && longest < kSettled_s) break;
  }
  ClockOffsets offsets{at.clock_s, std::vector<double>(at.clock_s.size(), std::numeric_limits<double>::infinity())};
  // Differences from the mean clock: a common offset has no effect.
  const Eigen::MatrixXd share = Eigen::MatrixXd::Identity(n, n) - Eigen::MatrixXd::Constant(n, n, 1.0 / n);
  const Eigen::MatrixXd ridge = Eigen::MatrixXd::Identity(n, n) * 1e-3 * std::max(1.0, equations.information.trace());
  const Eigen::MatrixXd common = Eigen::MatrixXd::Constant(n, n, equations.information.trace() / (n * n));
  const Eigen::MatrixXd inverse = (equations.information + common + 1e-6 * ridge).inverse();
  const Eigen::VectorXd variance = VarianceBySpans(equations.of_moment, share * inverse);
  for (Eigen::Index v = 0; v < n; ++v) {
    const double apparent = equations.information(v, v);
    const double real = std::max(apparent - equations.by_noise[v], 0.02 * apparent);
    const double sigma = std::sqrt(variance[v]) * apparent / real;
    if (apparent > 0.0 && sigma < kUndetermined_s) offsets.sigma_s[static_cast<std::size_t>(v)] = sigma;
  }
  const std::size_t common_clock = CommonClock(offsets);
  const double common_s = offsets.clock_s[common_clock];
  const double common_sigma_s = offsets.sigma_s[common_clock];
  for (std::size_t v = 0; v < offsets.clock_s.size(); ++v) {
    offsets.clock_s[v] -= common_s;
    if (v != common_clock) offsets.sigma_s[v] = std::hypot(offsets.sigma_s[v], common_sigma_s);
  }
  return offsets;
}

std::vector<double> ChangeOfClocks(const RigSamples& samples, const RigModel& model, const RigModel& calibrated,
                                   const TriangulationOptions& options) {
  const std::size_t views = samples.views();
  std::vector<RigModel> others(1, model);
  others[0].camera = calibrated.camera;
  for (std::size_t k = 0; k < views && views >= kFewestViewsToDrop; ++k) {
    others.push_back(model);
    others.back().camera[k].resize(1, model.camera[k][0]);
    others.back().camera[k][0].from_s = std::numeric_limits<double>::infinity();  // exclude its second part
  }
  std::vector<double> change(views, 0.0);
  for (const RigModel& other : others) {
    const ClockOffsets clocks = RefineClocks(samples, other, options);
    std::vector<double> differences;  // another camera may define the common clock
    for (std::size_t v = 0; v < views; ++v) {
      if (std::isfinite(clocks.sigma_s[v])) differences.push_back(clocks.clock_s[v] - model.clock_s[v]);
    }
    const double common_s = MeanMedian(differences);
    for (std::size_t v = 0; v < views; ++v) {
      if (!std::isfinite(clocks.sigma_s[v])) continue;
      change[v] = std::max(change[v], std::abs(clocks.clock_s[v] - model.clock_s[v] - common_s));
    }
  }
  return change;
}

}  // namespace mocurate
