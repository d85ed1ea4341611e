#include "fitting/uncertainty/track_uncertainty.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "fitting/solver/block_tridiagonal.h"
#include "fitting/solver/one_thread.h"
#include "fitting/solver/track_equations.h"

namespace mocurate {
namespace {

constexpr double kUnknownAngle = 3.289868133696453;  ///< variance of a uniform angle, pi^2 / 3
constexpr double kSmallestFactor = 0.25;  ///< tracks without noise are not taken for better than half their floor
constexpr double kSmallestShare = 0.2;    ///< of an observation's three coordinates that count as left over, at least

/// Frames whose inverse is taken together: [begin, end) of a wider window that reaches `context` further on both sides.
struct Part {
  int begin = 0;
  int end = 0;
  int window_begin = 0;
  int window_end = 0;
};

std::vector<Part> PartsOf(const TrackWindow& whole) {
  const int length = static_cast<int>(whole.options.window_frames);
  const int context = static_cast<int>(whole.options.window_overlap);
  std::vector<Part> parts;
  for (int begin = 0; begin < whole.end; begin += length) {
    Part part;
    part.begin = begin;
    part.end = std::min(begin + length, whole.end);
    part.window_begin = std::max(begin - context, 0);
    part.window_end = std::min(part.end + context, whole.end);
    parts.push_back(part);
  }
  return parts;
}

/// Variance of a joint's angle per axis without evidence, by frame: a random walk tied to the rest pose, cut at gaps.
std::vector<double> PriorVariance(const TrackWindow& whole) {
  const double rest = 1.0 / (whole.options.rest_spread * whole.options.rest_spread);
  /// Information of a Gaussian chain that reaches the other side of a step.
  const auto through = [&](int f, double information) {
    if (!whole.Joined(f)) return 0.0;
    const double walk = 1.0 / (whole.options.rotation_walk * whole.options.rotation_walk * whole.Step(f));
    return walk * information / (walk + information);
  };
  std::vector<double> information(whole.end, rest);
  double reaching = 0.0;
  for (int f = 1; f < whole.end; ++f) information[f] += reaching = through(f - 1, reaching + rest);
  reaching = 0.0;
  for (int f = whole.end - 2; f >= 0; --f) information[f] += reaching = through(f, reaching + rest);
  for (double& value : information) value = std::min(1.0 / value, kUnknownAngle);
  return information;
}

/// What the residuals say about the noise: sum of weighted squares, and how many numbers they leave free.
struct Freedom {
  double squares = 0.0;
  double numbers = 0.0;
};

class Reader {
 public:
  Reader(const TrackWindow& window, const TrackEquations& track, const std::vector<double>& prior, PoseUncertainty& out,
         Freedom& freedom)
      : window_(window), track_(track), prior_(prior), out_(out), freedom_(freedom) {}

  void Read(int frame, const Eigen::MatrixXd& covariance) {
    const PoseState& state = window_.state;
    for (int j = 0; j < state.joints(); ++j) {
      const std::size_t at = static_cast<std::size_t>(frame) * state.joints() + j;
      const Matrix3d position = PositionCovariance(frame, j, covariance);
      WritePosition(at, position);
      WriteRotation(at, frame, j, covariance);
      if (!window_.tracks.seen(frame, j)) continue;
      const double weight = track_.DataWeight(frame, j);
      const Vector3d away = state.position(frame, j) - window_.tracks.positions.at(frame, j);
      freedom_.squares += weight * away.squaredNorm();
      freedom_.numbers += std::max(3.0 - weight * position.trace(), 3.0 * kSmallestShare);
    }
  }

 private:
  /// dp = sum over the joint's path of P_a dw_a, and the translation.
  Matrix3d PositionCovariance(int frame, int joint, const Eigen::MatrixXd& covariance) {
    const PoseState& state = window_.state;
    const auto& path = state.path(joint);
    const auto unknowns = static_cast<Eigen::Index>(3 + 3 * path.size());
    derivative_.resize(3, unknowns);
    derivative_.leftCols<3>().setIdentity();
    columns_.assign(1, 0);
    for (std::size_t i = 0; i < path.size(); ++i) {
      const Vector3d arm = state.position(frame, path[i]) - state.position(frame, joint);
      derivative_.middleCols<3>(static_cast<Eigen::Index>(3 + 3 * i)).noalias() =
          Hat(arm) * state.lever(frame, path[i]);
      columns_.push_back(track_.column(path[i]));
    }
    Matrix3d sum = Matrix3d::Zero();
    for (std::size_t b = 0; b < columns_.size(); ++b) {
      Matrix3d left = Matrix3d::Zero();
      for (std::size_t a = 0; a < columns_.size(); ++a) {
        left.noalias() += derivative_.middleCols<3>(static_cast<Eigen::Index>(3 * a)) *
                          covariance.block<3, 3>(columns_[a], columns_[b]);
      }
      sum.noalias() += left * derivative_.middleCols<3>(static_cast<Eigen::Index>(3 * b)).transpose();
    }
    return sum;
  }

  void WritePosition(std::size_t at, const Matrix3d& c) {
    const double values[6] = {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
    for (int i = 0; i < 6; ++i) out_.position_cov[6 * at + i] = static_cast<float>(values[i]);
  }

  void WriteRotation(std::size_t at, int frame, int joint, const Eigen::MatrixXd& covariance) {
    const double prior = joint == 0 ? kUnknownAngle : prior_[frame];
    Vector3d variance = Vector3d::Constant(prior);
    if (const int column = track_.column(joint); column >= 0) {
      const Matrix3d& jacobian = window_.state.right_jacobian(frame, joint);
      variance = (jacobian * covariance.block<3, 3>(column, column) * jacobian.transpose()).diagonal();
    }
    for (int i = 0; i < 3; ++i) {
      out_.rotation_sigma[3 * at + i] = static_cast<float>(std::sqrt(std::min(variance[i], kUnknownAngle)));
      out_.rotation_observed[3 * at + i] = static_cast<float>(std::clamp(1.0 - variance[i] / prior, 0.0, 1.0));
    }
  }

  const TrackWindow& window_;
  const TrackEquations& track_;
  const std::vector<double>& prior_;
  PoseUncertainty& out_;
  Freedom& freedom_;
  Eigen::Matrix<double, 3, Eigen::Dynamic> derivative_;
  std::vector<int> columns_;
};

/// Residuals decide how far the noise was right: what the evidence says counts `factor` less. A position that is not
/// seen in its frame, and the prior's part of a rotation, stay.
void Scale(const SkeletonTracks& tracks, const std::vector<double>& prior, double factor,
           PoseUncertainty& uncertainty) {
  uncertainty.variance_factor = factor;
  for (int f = 0; f < tracks.frames(); ++f) {
    for (int j = 0; j < tracks.joints(); ++j) {
      const std::size_t at = static_cast<std::size_t>(f) * tracks.joints() + j;
      for (int i = 0; tracks.seen(f, j) && i < 6; ++i) {
        uncertainty.position_cov[6 * at + i] = static_cast<float>(factor * uncertainty.position_cov[6 * at + i]);
      }
      for (int i = 0; i < 3; ++i) {
        float& observed = uncertainty.rotation_observed[3 * at + i];
        if (observed == 0.0F) continue;
        // variance / prior = 1 / (1 + d), d the information of the evidence in units of the prior's.
        const double evidence = observed / (1.0 - std::min<double>(observed, 1.0 - 1e-9)) / factor;
        const double share = 1.0 / (1.0 + evidence);
        observed = static_cast<float>(1.0 - share);
        const double variance = share * (j == 0 ? kUnknownAngle : prior[f]);
        uncertainty.rotation_sigma[3 * at + i] = static_cast<float>(std::sqrt(variance));
      }
    }
  }
}

}  // namespace

Expected<PoseUncertainty> UncertaintyOfTracks(const TrackWindow& whole) {
  const OneThread one_thread;
  const auto numbers = static_cast<std::size_t>(whole.end) * whole.state.joints();
  PoseUncertainty uncertainty;
  uncertainty.position_cov.assign(6 * numbers, 0.0F);
  uncertainty.rotation_sigma.assign(3 * numbers, 0.0F);
  uncertainty.rotation_observed.assign(3 * numbers, 0.0F);
  const std::vector<double> prior = PriorVariance(whole);
  whole.state.Update(0, whole.end, true);
  Freedom freedom;
  for (const Part& part : PartsOf(whole)) {
    const TrackWindow window{whole.tracks,  whole.state,   whole.joint_sigma, whole.bone_prior,
                             Bones::kFixed, whole.options, part.window_begin, part.window_end};
    TrackEquations track(window);
    BlockTridiagonal equations(part.window_end - part.window_begin, track.size(), 0);
    track.Linearise(equations);
    if (!equations.Factor(Eigen::VectorXd::Zero(equations.blocks() * equations.size()))) {
      return Fail(ErrorCode::kInternal, "the pose is not determined, not even by its priors",
                  "frames " + std::to_string(part.begin) + " to " + std::to_string(part.end));
    }
    Reader reader(window, track, prior, uncertainty, freedom);
    equations.VisitInverse([&](int f, const Eigen::MatrixXd& covariance, const Eigen::MatrixXd&) {
      const int frame = part.window_begin + f;
      if (frame >= part.begin && frame < part.end) reader.Read(frame, covariance);
    });
  }
  if (freedom.numbers > 0.0)
    Scale(whole.tracks, prior, std::max(freedom.squares / freedom.numbers, kSmallestFactor), uncertainty);
  return uncertainty;
}

}  // namespace mocurate
