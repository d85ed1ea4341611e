#include "fitting/uncertainty/track_uncertainty.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/rotation.h"
#include "fitting/uncertainty/body_sigma.h"
#include "fitting/uncertainty/calibration.h"
#include "fitting/uncertainty/frame_covariances.h"
#include "fitting/uncertainty/pose_posterior.h"
#include "fitting/uncertainty/variance_inflation.h"

namespace mocurate {
namespace {

/// Factor on the variance, at least: tracks without noise have half the assumed sigma.
constexpr double kSmallestFactor = 0.25;
/// Factor on the variance without that rule: covariances must be invertible (numerical).
constexpr double kPositiveFactor = 1e-6;
constexpr double kSmallestShare = 0.2;  ///< of an observation's three coordinates that count as redundant, at least

constexpr double kSmallestVariance = 1e-12;  ///< m^2, of three axes (numerical)

/// Variance of a joint's rotation per axis of its frame without evidence (F*J): that of the same equations (rest pose,
/// limits, hinges, process noise) where every joint is seen with a sigma of 1e4 times its own, which only keeps the
/// person in the world. At most the typical rotation of people.
Expected<std::vector<Vector3d>> PriorVariance(const TrackProblem& whole) {
  constexpr double kFaint = 1e-4;  ///< confidence of observations without effect (numerical)
  SkeletonTracks faint = whole.tracks;
  faint.precision.clear();
  std::fill(faint.confidence.begin(), faint.confidence.end(), kFaint);
  for (int f = 0; f < whole.frames(); ++f) {
    for (int j = 0; j < faint.joints(); ++j) faint.positions.at(f, j) = whole.state.position(f, j);
  }
  TrackProblem blind(faint, whole.state, whole.sigma, whole.options);
  blind.noise_scale = whole.noise_scale;
  blind.rest_sigma = whole.rest_sigma;
  blind.shown = whole.shown;
  blind.memory = whole.memory;
  std::vector<Vector3d> prior(faint.confidence.size());
  const Status visited = VisitCovariances(blind, [&](const FrameCovariance& of_frame) {
    for (int j = 0; j < faint.joints(); ++j) {
      Vector3d variance =
          Vector3d::Constant(j == 0 ? kUnknownAngle : Square(whole.rest_sigma[static_cast<std::size_t>(j)]));
      if (const int column = of_frame.columns.of(j); j > 0 && column >= 0)
        variance = variance.cwiseMin(RotationVariance(whole.state, of_frame.frame, j, of_frame.own, column));
      prior[whole.Index(of_frame.frame, j)] = variance;
    }
  });
  if (!visited) return tl::unexpected<Error>(visited.error());
  return prior;
}

/// Residual statistics: sum of weighted squares, and redundancy.
struct Freedom {
  double squares = 0.0;
  double numbers = 0.0;
  double samples = 0.0;
  double leverage = 0.0;  ///< sum of a sample's weight in its joint's position, per axis
};

class Reader {
 public:
  Reader(const TrackProblem& window, const std::vector<Vector3d>& prior, PoseUncertainty& out, Freedom& freedom)
      : window_(window), prior_(prior), out_(out), freedom_(freedom) {}

  void Read(const FrameCovariance& of_frame) {
    const PoseState& state = window_.state;
    const int frame = of_frame.frame;
    const auto first = prior_.begin() + static_cast<std::ptrdiff_t>(window_.Index(frame, 0));
    const PosePosterior posterior =
        PosteriorOf(of_frame.columns, state, frame, of_frame.own, {first, first + state.joints()});
    if (window_.options.poses) WritePose(of_frame);
    for (int j = 0; j < state.joints(); ++j) {
      const std::size_t at = window_.Index(frame, j);
      const Matrix3d& position = posterior.position[j];
      ToSixNumbers(position, out_.position_cov.data() + 6 * at);
      for (int i = 0; i < 3; ++i) {
        const double variance = posterior.rotation[j][i];
        out_.rotation_sigma[3 * at + i] = static_cast<float>(std::sqrt(variance));
        out_.rotation_observed[3 * at + i] = static_cast<float>(1.0 - variance / posterior.prior[j][i]);
      }
      if (!window_.tracks.seen(frame, j)) continue;
      const Matrix3d information = window_.RobustInformation(frame, j);
      const Vector3d away = state.position(frame, j) - window_.tracks.positions.at(frame, j);
      freedom_.squares += away.dot(information * away);
      const double leverage = information.cwiseProduct(position).sum();
      freedom_.numbers += std::max(3.0 - leverage, 3.0 * kSmallestShare);
      freedom_.samples += 1.0;
      freedom_.leverage += leverage / 3.0;
    }
  }

 private:
  /// Rows and columns of rotation vectors, turned into those of rotations in the joints' frames.
  void WritePose(const FrameCovariance& of_frame) {
    PoseCovariances& poses = out_.poses;
    poses.column.clear();
    Eigen::MatrixXd& covariance = poses.frame[static_cast<std::size_t>(of_frame.frame)];
    covariance = of_frame.own;
    for (int j = 0; j < window_.state.joints(); ++j) {
      const int column = of_frame.columns.of(j);
      poses.column.push_back(column);
      if (column < 0) continue;
      const Matrix3d& jacobian = window_.state.right_jacobian(of_frame.frame, j);
      covariance.middleRows<3>(column) = (jacobian * covariance.middleRows<3>(column)).eval();
      covariance.middleCols<3>(column) = (covariance.middleCols<3>(column) * jacobian.transpose()).eval();
    }
  }

  const TrackProblem& window_;
  const std::vector<Vector3d>& prior_;
  PoseUncertainty& out_;
  Freedom& freedom_;
};

/// Factors on the covariances of positions, (F*J): `factor` where a joint is observed; else that of its gap, but at
/// least the smaller variance at the gap's two ends.
std::vector<double> FactorsOfPositions(const SkeletonTracks& tracks, const std::vector<double>& growth, double factor,
                                       const std::vector<float>& position_cov, bool at_least_ends) {
  std::vector<double> factors(growth.size());
  const auto variance = [&](std::size_t at) {
    return static_cast<double>(position_cov[6 * at]) + position_cov[6 * at + 3] + position_cov[6 * at + 5];
  };
  const auto joints = static_cast<std::size_t>(tracks.joints());
  for (std::size_t j = 0; j < joints; ++j) {
    double before = 0.0;  // variance where it was last observed; 0: never
    for (int f = 0; f < tracks.frames(); ++f) {
      const std::size_t at = static_cast<std::size_t>(f) * joints + j;
      if (tracks.seen(f, static_cast<int>(j))) {
        factors[at] = factor;
        before = factor * variance(at);
        continue;
      }
      int next = f;
      while (next < tracks.frames() && !tracks.seen(next, static_cast<int>(j))) ++next;
      const double after =
          next < tracks.frames() ? factor * variance(static_cast<std::size_t>(next) * joints + j) : 0.0;
      const double ends = before > 0.0 && after > 0.0 ? std::min(before, after) : std::max(before, after);
      const double least = at_least_ends ? ends : 0.0;
      for (; f < next; ++f) {
        const std::size_t unseen = static_cast<std::size_t>(f) * joints + j;
        factors[unseen] = std::max(growth[unseen], least / std::max(variance(unseen), kSmallestVariance));
      }
      --f;
    }
  }
  return factors;
}

/// Scales the variance from evidence by `factor`, the a-posteriori variance. Positions unobserved in their frame, and
/// the prior's part of a rotation, are unchanged.
void Scale(const SkeletonTracks& tracks, const std::vector<Vector3d>& prior, double factor, const Rules& rules,
           PoseUncertainty& uncertainty) {
  if (rules.on(FittingRule::kUncertaintyCalibration)) factor *= kUncertaintyCalibration;
  const std::vector<double> ones(tracks.confidence.size(), 1.0);
  const GapInflation growth =
      rules.on(FittingRule::kGapInflation) ? FindGapInflation(tracks) : GapInflation{ones, ones};
  const std::vector<double> of_positions =
      FactorsOfPositions(tracks, growth.position, factor, uncertainty.position_cov, rules.on(FittingRule::kGapFloor));
  for (int f = 0; f < tracks.frames(); ++f) {
    for (int j = 0; j < tracks.joints(); ++j) {
      const std::size_t at = static_cast<std::size_t>(f) * tracks.joints() + j;
      for (int i = 0; i < 6; ++i) {
        float& value = uncertainty.position_cov[6 * at + i];
        value = static_cast<float>(of_positions[at] * value);
      }
      const double of_rotation = growth.rotation[at] > 1.0 ? std::max(growth.rotation[at], factor) : factor;
      for (int i = 0; i < 3; ++i) {
        float& observed = uncertainty.rotation_observed[3 * at + i];
        if (observed == 0.0F) continue;
        // variance / prior = 1 / (1 + d), d the information of the evidence in units of the prior's.
        const double evidence = observed / (1.0 - std::min<double>(observed, 1.0 - 1e-9)) / of_rotation;
        const double share = 1.0 / (1.0 + evidence);
        observed = static_cast<float>(1.0 - share);
        const double variance = share * prior[at][i];
        uncertainty.rotation_sigma[3 * at + i] = static_cast<float>(std::sqrt(variance));
      }
    }
  }
}

/// Adds the covariance of frame orientations between bodies, the joint's own and its parent's, to rotations that
/// evidence determines.
void AddFrameOrientations(const TrackProblem& whole, PoseUncertainty& uncertainty) {
  const std::vector<Matrix3d> frame_covariance = FrameOrientationCovariance(whole);
  for (int f = 0; f < whole.frames(); ++f) {
    for (int j = 0; j < whole.state.joints(); ++j) {
      const std::size_t at = whole.Index(f, j);
      Matrix3d added = frame_covariance[j];
      if (const int parent = whole.state.parent(j); parent >= 0) {
        const Matrix3d& parent_from_joint = whole.state.local(f, j);
        added += parent_from_joint.transpose() * frame_covariance[parent] * parent_from_joint;
      }
      for (int i = 0; i < 3; ++i) {
        WidenRotation(added(i, i), uncertainty.rotation_sigma[3 * at + i], uncertainty.rotation_observed[3 * at + i]);
      }
    }
  }
}

}  // namespace

Expected<PoseUncertainty> UncertaintyOfTracks(const TrackProblem& whole, double least_factor) {
  const Rules& rules = whole.options.rules;
  const auto numbers = static_cast<std::size_t>(whole.frames()) * whole.state.joints();
  PoseUncertainty uncertainty;
  uncertainty.position_cov.assign(6 * numbers, 0.0F);
  uncertainty.rotation_sigma.assign(3 * numbers, 0.0F);
  uncertainty.rotation_observed.assign(3 * numbers, 0.0F);
  whole.state.Update(0, whole.frames(), true);
  const Expected<std::vector<Vector3d>> known = PriorVariance(whole);
  if (!known) return Forward(known);
  const std::vector<Vector3d>& prior = *known;
  if (whole.options.poses) {
    uncertainty.poses.frame.resize(static_cast<std::size_t>(whole.frames()));
    uncertainty.poses.rest_sigma = whole.rest_sigma;
  }
  Freedom freedom;
  Reader reader(whole, prior, uncertainty, freedom);
  Status visited = VisitCovariances(whole, [&](const FrameCovariance& covariance) { reader.Read(covariance); });
  if (!visited) return tl::unexpected<Error>(visited.error());
  if (freedom.numbers > 0.0) {
    const double found = rules.on(FittingRule::kVarianceFactor) ? freedom.squares / freedom.numbers : 1.0;
    const double smallest = rules.on(FittingRule::kLeastVarianceFactor) ? kSmallestFactor : kPositiveFactor;
    const double factor = std::max({found, smallest, least_factor});
    const double averaged = freedom.samples / std::max(freedom.leverage, 1e-9);
    const double inflation =
        rules.on(FittingRule::kAutocorrelatedError) ? AutocorrelationInflation(whole, averaged) : 1.0;
    Scale(whole.tracks, prior, factor * inflation, rules, uncertainty);
    uncertainty.variance_factor = factor;
    std::vector<float> persistent;
    if (rules.on(FittingRule::kPersistentResiduals)) persistent = PersistentResidualCovariance(whole, factor);
    for (std::size_t i = 0; i < persistent.size(); ++i) uncertainty.position_cov[i] += persistent[i];
  }
  if (rules.on(FittingRule::kFrameOrientation)) AddFrameOrientations(whole, uncertainty);
  std::vector<float> of_body;
  if (rules.on(FittingRule::kBodyCovariance)) of_body = CovarianceOfBody(whole);
  for (std::size_t i = 0; i < of_body.size(); ++i) uncertainty.position_cov[i] += of_body[i];
  if (rules.on(FittingRule::kSecondOrderCovariance)) AddSecondOrderCovariance(whole, uncertainty.position_cov);
  return uncertainty;
}

}  // namespace mocurate
