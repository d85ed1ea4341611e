#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/base/error.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/options.h"
#include "fitting/terms/terms.h"

namespace mocurate {

/// Result of a solve.
struct CapsuleFitOutcome {
  double initial_cost = 0.0;
  double final_cost = 0.0;
  double sigma =
      0.0;  ///< m, standard deviation of a point's distance in the last solve, for whose problem a covariance is
  double residual = 0.0;  ///< m, robust standard deviation of the distances in the last matching
  double moved = 0.0;     ///< m, mean movement of the joints in the last matching
  int iterations = 0;     ///< number of matchings
  bool converged = false;
};

/// m; standard deviation of a point's distance where poses are compared: error of a capsule body.
inline constexpr double kComparedSigma = 0.01;

/// A fixed neighbouring frame, coupled by the process noise of the options.
struct FixedNeighbourFrame {
  int step = -1;         ///< -1: the frame before, 1: the frame after
  double seconds = 0.0;  ///< between them
};

/// Settings for the fit of one frame.
struct FrameFit {
  int frame = 0;
  std::vector<FixedNeighbourFrame> held;  ///< fixed neighbouring frames
  double widening = 1.0;                  ///< factor on max_distance in the first matching, decreasing later
  int iterations = 40;                    ///< matchings, at most
  std::vector<PointTerm> joints = {};     ///< joint positions from other modalities
  const PoseGaussian* pose = nullptr;     ///< of other evidence, which has priors of its joints already
  double point_weight = 1.0;              ///< factor on the weight of points: below 1 when the whole body is off
  /// m, of a point's distance where the distance limit is not widened; 0: measured at the first matching, and once more
  /// at the minimum. With a widened limit it is measured at every matching.
  double sigma = 0.0;
  PoseSolver solver = PoseSolver::kBanded;  ///< of searches; the fit that is the answer has that of the options
};

inline FrameFit FitOf(int frame, const PointCloudOptions& options) {
  FrameFit fit;
  fit.frame = frame;
  fit.iterations = static_cast<int>(options.iterations);
  return fit;
}

/// Fit of a pose that is compared with others of the same cloud.
inline FrameFit ComparedFit(int frame, std::int64_t iterations, double widening = 1.0) {
  FrameFit fit;
  fit.frame = frame;
  fit.iterations = static_cast<int>(iterations);
  fit.widening = widening;
  fit.sigma = kComparedSigma;
  return fit;
}

/// Fits one frame from the pose in the state: minimises PoseCost by alternating matching and solving until the joints
/// settle, or until a matching finds a higher cost than the one before; then the pose before stays. Error kInconsistent
/// if the solver fails.
Expected<CapsuleFitOutcome> FitCloudFrame(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                                          PoseState& state, const PointCloudOptions& options);

/// Mean distance of a frame's points to the body in metres, each at most `max_distance`, to compare starts. Needs
/// Update.
double MeanDistance(const CapsuleBody& body, const FusedCloud& cloud, const PoseState& state, int frame,
                    double max_distance);

/// Cost of the pose in the state that FitCloudFrame minimises: distances of all points (unmatched points at their
/// limit) by the fit's sigma, priors, neighbours and other evidence. Compares poses of one cloud and one fit, whose
/// sigma must be given. Needs Update.
double PoseCost(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit, PoseState& state,
                const PointCloudOptions& options);

/// (N) The part of PoseCost of each point. Needs Update.
std::vector<double> PointCosts(const CapsuleBody& body, const FusedCloud& cloud, const FrameFit& fit,
                               const PoseState& state, const PointCloudOptions& options);

/// Difference of the costs of two poses, and its variance. Errors of neighbouring points are common, so that it is the
/// sum of the differences of patches of 15 cm, whose variance is theirs (Vuong 1989, models that are not nested).
struct CostDifference {
  double sum = 0.0;
  double variance = 0.0;

  double sigma() const { return std::sqrt(variance); }
  CostDifference& operator+=(const CostDifference& other) {
    sum += other.sum, variance += other.variance;
    return *this;
  }
};
/// `costs` less `other`, both of the points of `cloud`.
CostDifference Compare(const FusedCloud& cloud, const std::vector<double>& costs, const std::vector<double>& other);

}  // namespace mocurate
