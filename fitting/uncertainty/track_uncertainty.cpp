#include "fitting/uncertainty/track_uncertainty.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/rotation.h"
#include "fitting/uncertainty/body_response.h"
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

/// Scales the variance from evidence by `factor`, the a-posteriori variance, or by what a long gap inflates it.
/// Positions unobserved in their frame are only widened, the prior's part of a rotation is unchanged.
void Scale(const SkeletonTracks& tracks, const std::vector<Vector3d>& prior, double factor, const Rules& rules,
           PoseUncertainty& uncertainty) {
  if (rules.on(FittingRule::kUncertaintyCalibration)) factor *= kUncertaintyCalibration;
  const std::vector<double> ones(tracks.confidence.size(), 1.0);
  const GapInflation growth =
      rules.on(FittingRule::kGapInflation) ? FindGapInflation(tracks) : GapInflation{ones, ones};
  for (int f = 0; f < tracks.frames(); ++f) {
    for (int j = 0; j < tracks.joints(); ++j) {
      const std::size_t at = static_cast<std::size_t>(f) * tracks.joints() + j;
      const double of_position = tracks.seen(f, j) ? factor : std::max(factor, growth.position[at]);
      const double of_rotation = growth.rotation[at] > 1.0 ? std::max(growth.rotation[at], factor) : factor;
      for (int i = 0; i < 6; ++i) {
        float& value = uncertainty.position_cov[6 * at + i];
        value = static_cast<float>(of_position * value);
      }
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

constexpr double kShortestBone_m = 1e-3;  ///< shorter bones are between joints that coincide by definition
constexpr double kStep_s = 0.2;           ///< people rotate little in this time (numerical)

/// Of the body that the tracks were fitted with: where some frame shows both ends of a bone, its length is measured.
BodyDeviations DeviationsOfTracks(const TrackProblem& whole) {
  const Skeleton& skeleton = *whole.tracks.skeleton;
  const auto joints = static_cast<std::size_t>(skeleton.joint_count());
  BodyDeviations deviations{std::vector<double>(joints, 0.0)};
  deviations.length_measured.assign(joints, false);
  deviations.point = whole.tracks.place_sigma;
  for (const double sigma : whole.rest_sigma) deviations.fixed.push_back(std::min(sigma, std::sqrt(kUnknownAngle)));
  for (int j = 1; j < whole.state.joints(); ++j) {
    const auto at = static_cast<std::size_t>(j), start = static_cast<std::size_t>(whole.state.parent(j));
    deviations.length_measured[at] = whole.shown[at] && whole.shown[start];
    if (*whole.state.bone(j) > kShortestBone_m) deviations.bone[at] = SpreadOfBone(skeleton, j);
  }
  return deviations;
}

/// A frame's terms with every joint that the tracks show in any frame, and the rest pose as in the middle of the clip:
/// a body's error is constant.
PoseTerms TermsOfAllShown(const TrackProblem& whole, int frame) {
  PoseTerms terms = whole.Terms(frame, frame + 1, false);
  if (whole.frames() > 2) {
    const int inside = std::clamp(frame, 1, whole.frames() - 2);
    for (int j = 0; j < whole.state.joints(); ++j)
      terms.frames.front().priors[static_cast<std::size_t>(j)].rest = whole.RestInformation(inside, j);
  }
  for (int j = 0; j < whole.state.joints(); ++j) {
    if (!whole.shown[static_cast<std::size_t>(j)] || whole.tracks.seen(frame, j)) continue;
    terms.frames.front().points.push_back({j, whole.state.position(frame, j), Matrix3d::Identity() / whole.sigma});
  }
  return terms;
}

/// Adds what a body that is not the person's does to the pose: computed every 0.2 s, linear between.
void AddBody(const TrackProblem& whole, PoseUncertainty& uncertainty) {
  const BodyDeviations deviations = DeviationsOfTracks(whole);
  const std::vector<double>& time_s = whole.tracks.time_s;
  const auto of_frame = [&](int f) { return BodyResponse(TermsOfAllShown(whole, f), whole.state, 0, deviations); };
  BodyResponse before = of_frame(0), after = before;
  int begin = 0;
  const auto add = [&](int f, double share) {
    for (int j = 0; j < whole.state.joints(); ++j) {
      const std::size_t at = whole.Index(f, j);
      const Matrix3d position = (1.0 - share) * before.position()[j] + share * after.position()[j];
      float* stated = uncertainty.position_cov.data() + 6 * at;
      ToSixNumbers(FromSixNumbers(stated) + position, stated);
      const Vector3d rotation = ((1.0 - share) * before.rotation()[j] + share * after.rotation()[j]).diagonal();
      for (int i = 0; i < 3; ++i)
        WidenRotation(rotation[i], uncertainty.rotation_sigma[3 * at + i], uncertainty.rotation_observed[3 * at + i]);
    }
  };
  add(0, 0.0);
  for (int f = 1; f < whole.frames(); ++f) {
    if (f < whole.frames() - 1 && time_s[f] - time_s[begin] < kStep_s) continue;
    after = of_frame(f);
    for (int g = begin + 1; g <= f; ++g) add(g, (time_s[g] - time_s[begin]) / (time_s[f] - time_s[begin]));
    before = after;
    begin = f;
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
  if (rules.on(FittingRule::kBodyErrors)) AddBody(whole, uncertainty);
  return uncertainty;
}

}  // namespace mocurate
