#include "fitting/evidence/rotation_targets.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/base/median.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/geometry/rotation.h"

namespace mocurate {
namespace {

constexpr double kMinRotationSigma = 0.5 * kPi / 180.0;  ///< rad; no recording is finer
/// rad; with more scatter, recorded rotations are not those of the joint.
constexpr double kLargestSigma = 30.0 * kPi / 180.0;
constexpr std::size_t kFewest = 10;  ///< samples; with fewer, neither constant offset nor scatter can be estimated
/// rad; smaller departures get this weight in the mean (numerical).
constexpr double kNearTarget = 0.02;
constexpr int kMeanIterations = 10;  ///< of the reweighted mean (numerical)

/// Rotation with the least sum of weighted squared distances to `rotations` (Markley and others 2007).
Quaterniond WeightedMean(const std::vector<Quaterniond>& rotations, const std::vector<double>& weights) {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (std::size_t i = 0; i < rotations.size(); ++i) {
    const Eigen::Vector4d q = rotations[i].coeffs();
    sum += weights[i] * q * q.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(sum);
  Quaterniond mean;
  mean.coeffs() = solver.eigenvectors().col(3);
  return mean.normalized();
}

/// Rotation with about the least sum of distances: iteratively reweighted mean (L1).
Quaterniond MiddleRotation(const std::vector<Quaterniond>& rotations, const std::vector<double>& confidence) {
  Quaterniond middle = WeightedMean(rotations, confidence);
  std::vector<double> weights(rotations.size());
  for (int iteration = 0; iteration < kMeanIterations; ++iteration) {
    for (std::size_t i = 0; i < rotations.size(); ++i) {
      weights[i] = confidence[i] / std::max(LogQuaternion(middle.conjugate() * rotations[i]).norm(), kNearTarget);
    }
    middle = WeightedMean(rotations, weights);
  }
  return middle;
}

/// Standard deviation per axis, from the median departure.
double Scatter(const std::vector<Quaterniond>& rotations, const Quaterniond& middle) {
  std::vector<double> departures;
  for (const Quaterniond& rotation : rotations) {
    const Vector3d away = LogQuaternion(middle.conjugate() * rotation);
    for (int i = 0; i < 3; ++i) departures.push_back(std::abs(away[i]));
  }
  const auto half = departures.begin() + static_cast<std::ptrdiff_t>(departures.size() / 2);
  std::nth_element(departures.begin(), half, departures.end());
  const auto count = static_cast<double>(rotations.size());
  return std::max(kMadToSigma * *half * std::sqrt(count / (count - 1.0)),
                  kMinRotationSigma);  // the middle is an estimate from the same samples
}

Finding TooFew(int joints) {
  return MakeFinding(
      "rotations_too_few", Severity::kInfo, joints,
      "rotations of " + Counted(joints, "joint") + " are recorded in fewer than " + std::to_string(kFewest) +
          " frames: too few to estimate the offset between recorded and skeleton frames; the rotations are not used",
      FindingAction::kExcluded);
}

Finding Disagreement(const std::string& joint, double sigma) {
  const double degrees = sigma * 180.0 / kPi;
  Finding finding = MakeFinding("rotations_disagree", Severity::kWarning, degrees,
                                "the recorded rotations do not follow the joint: they scatter by " +
                                    FormatDouble(std::round(degrees)) + " degrees",
                                FindingAction::kExcluded);
  finding.joint = joint;
  return finding;
}

}  // namespace

RotationTargets AlignRotations(const SkeletonTracks& tracks, const PoseState& state, std::vector<Finding>* findings) {
  const auto joints = static_cast<std::size_t>(tracks.joints());
  RotationTargets targets;
  targets.world_from_joint.assign(tracks.rotation.size(), Quaterniond::Identity());
  targets.weight.assign(tracks.rotation.size(), 0.0);
  targets.joint_sigma.assign(joints, 0.0);
  int too_few = 0;
  for (int j = 0; j < tracks.joints(); ++j) {
    if (!state.active(j)) continue;
    std::vector<std::size_t> places;
    std::vector<Quaterniond> recorded_in_joint;
    std::vector<double> confidence;
    for (int f = 0; f < tracks.frames(); ++f) {
      const std::size_t at = static_cast<std::size_t>(f) * joints + static_cast<std::size_t>(j);
      if (!tracks.seen(f, j) || tracks.rotation_confidence[at] == 0.0) continue;
      places.push_back(at);
      recorded_in_joint.push_back(Quaterniond(state.global(f, j)).conjugate() * tracks.rotation[at]);
      confidence.push_back(tracks.rotation_confidence[at]);
    }
    if (places.empty()) continue;
    if (places.size() < kFewest) {
      ++too_few;
      continue;
    }
    const Quaterniond middle = MiddleRotation(recorded_in_joint, confidence);
    const double sigma = Scatter(recorded_in_joint, middle);
    if (sigma > kLargestSigma) {
      if (findings != nullptr) findings->push_back(Disagreement(tracks.skeleton->joints[j].name, sigma));
      continue;
    }
    targets.joint_sigma[j] = sigma;
    for (std::size_t i = 0; i < places.size(); ++i) {
      targets.world_from_joint[places[i]] = (tracks.rotation[places[i]] * middle.conjugate()).normalized();
      targets.weight[places[i]] = confidence[i] / sigma;
    }
  }
  if (too_few > 0 && findings != nullptr) findings->push_back(TooFew(too_few));
  return targets;
}

}  // namespace mocurate
