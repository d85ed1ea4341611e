#include "fitting/solver/bone_lengths.h"

#include <ceres/dynamic_autodiff_cost_function.h>
#include <ceres/normal_prior.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/base/median.h"
#include "fitting/evidence/noise.h"
#include "fitting/solver/one_thread.h"
#include "fitting/solver/rest_sigmas.h"
#include "fitting/terms/huber.h"

namespace mocurate {
namespace {

/// Estimate of the median squared distance without noise of covariance C (of the difference), from an observed one. A
/// square (d + e)'(d + e) has mean d'd + tr C and variance 4 d'C d + 2 tr C^2, and is skewed: its median lies below its
/// mean by third cumulant / (6 variance) (Cornish and Fisher). With one sigma at both ends of a long bone, the bias is
/// 4 sigma^2. At least a quarter of the observed square.
double SquareWithoutNoise(const Vector3d& seen, const Matrix3d& covariance) {
  const double squares = covariance.squaredNorm();
  const double cubes = (covariance * covariance).cwiseProduct(covariance).sum();
  // d'C d and d'C^2 d, corrected for the noise in the observed d.
  const double variance = std::max(4.0 * seen.dot(covariance * seen) - 2.0 * squares, 2.0 * squares);
  const double third = std::max(24.0 * (covariance * seen).squaredNorm() - 16.0 * cubes, 8.0 * cubes);
  const double skew = variance > 0.0 ? third / (6.0 * variance) : 0.0;
  const double square = seen.squaredNorm();
  return std::max(square - covariance.trace() + skew, 0.25 * square);
}

/// Weighted median; the mean of the two middle values in a tie. Sorts them.
double WeightedMedian(std::vector<std::pair<double, double>>& weighted) {
  std::sort(weighted.begin(), weighted.end());
  double all = 0.0;
  for (const auto& [value, weight] : weighted) all += weight;
  double below = 0.0;
  for (std::size_t i = 0; i < weighted.size(); ++i) {
    below += weighted[i].second;
    if (2.0 * below < all) continue;
    const bool between = 2.0 * below == all && i + 1 < weighted.size();
    return between ? 0.5 * (weighted[i].first + weighted[i + 1].first) : weighted[i].first;
  }
  return 0.0;
}

}  // namespace

/// Whether a joint is at exactly its parent's position, though the skeleton has a bone between them.
bool IsAtParent(const SkeletonTracks& clip, int frame, int joint) {
  constexpr double kShortBone = 0.01;  ///< m; joints that coincide in the skeleton may coincide
  const Joint& of = clip.skeleton->joints[joint];
  return of.parent >= 0 && of.rest_offset.norm() >= kShortBone && clip.seen(frame, joint) &&
         clip.seen(frame, of.parent) &&
         (clip.positions.at(frame, joint) - clip.positions.at(frame, of.parent)).isZero(0.0);
}

std::vector<bool> ShownJoints(const std::vector<SkeletonTracks>& clips) {
  std::vector<bool> shown(clips.empty() ? 0 : clips.front().skeleton->joints.size(), false);
  for (std::size_t j = 0; j < shown.size(); ++j) {
    const int joint = static_cast<int>(j);
    for (const SkeletonTracks& clip : clips) {
      for (int f = 0; f < clip.frames() && !shown[j]; ++f) {
        shown[j] = clip.seen(f, joint) && !IsAtParent(clip, f, joint);
      }
    }
  }
  return shown;
}

BoneDistance DistanceOver(const std::vector<SkeletonTracks>& clips, const std::vector<double>& white, int a, int b) {
  std::vector<std::pair<double, double>> lengths;  // length and weight
  BoneDistance distance;
  for (std::size_t c = 0; c < clips.size(); ++c) {
    for (int f = 0; f < clips[c].frames(); ++f) {
      if (!clips[c].seen(f, a) || !clips[c].seen(f, b)) continue;
      const Vector3d seen = clips[c].positions.at(f, a) - clips[c].positions.at(f, b);
      if (IsAtParent(clips[c], f, a) || IsAtParent(clips[c], f, b)) continue;
      const Matrix3d unit = UnitCovariance(clips[c], f, a) + UnitCovariance(clips[c], f, b);
      // Weights by the variance along an observed bone would be biased: they depend on the direction of the noise.
      const double confidence = std::min(clips[c].confidence_at(f, a), clips[c].confidence_at(f, b));
      distance.confidence += confidence * confidence;
      lengths.emplace_back(std::sqrt(SquareWithoutNoise(seen, white[c] * white[c] * unit)),
                           confidence / std::sqrt(unit.trace()));
    }
  }
  distance.samples = static_cast<int>(lengths.size());
  if (lengths.empty()) return distance;
  distance.length = WeightedMedian(lengths);
  std::vector<double> departures;
  for (const auto& [length, weight] : lengths) departures.push_back(std::abs(length - distance.length));
  distance.sigma = kMadToSigma * MeanMedian(departures);
  return distance;
}

namespace {

Vector3d Direction(const Skeleton& skeleton, int joint) {
  return skeleton.joints[joint].rest_offset.stableNormalized();
}

/// A measured distance over some bones: |start + sum of length times direction|.
struct Span {
  std::vector<int> bones;
  std::vector<Vector3d> directions;   ///< of each bone, unit
  double distance = 0.0;              ///< metres
  double sigma = 0.0;                 ///< of the distance, metres
  Vector3d start = Vector3d::Zero();  ///< metres
};

struct SpanResidual {
  const Span& span;

  template <class T>
  bool operator()(T const* const* lengths, T* residual) const {
    Eigen::Matrix<T, 3, 1> end = span.start.cast<T>();
    for (std::size_t i = 0; i < span.bones.size(); ++i) end += lengths[i][0] * span.directions[i].cast<T>();
    const T square = end.squaredNorm();
    residual[0] = square > T(1e-12) ? (sqrt(square) - span.distance) / span.sigma : T(0.0);
    return true;
  }
};

/// Lengths of the bones of some spans, nearest to the spans' distances and to the present lengths, each with its sigma.
/// Of a present length: its prior sigma and the least that it may become, metres.
void FitLengths(const std::vector<Span>& spans, const std::function<std::pair<double, double>(double)>& prior,
                BoneEstimate& bones) {
  if (spans.empty()) return;
  ceres::Problem problem;
  std::vector<bool> known(bones.length.size(), false);
  for (const Span& span : spans) {
    auto* cost = new ceres::DynamicAutoDiffCostFunction<SpanResidual>(new SpanResidual{span});
    cost->SetNumResiduals(1);
    std::vector<double*> lengths;
    for (const int bone : span.bones) {
      cost->AddParameterBlock(1);
      lengths.push_back(&bones.length[static_cast<std::size_t>(bone)]);
    }
    problem.AddResidualBlock(cost, nullptr, lengths);
    for (const int bone : span.bones) {
      if (known[static_cast<std::size_t>(bone)]) continue;
      known[static_cast<std::size_t>(bone)] = true;
      double& length = bones.length[static_cast<std::size_t>(bone)];
      const auto [sigma, least] = prior(length);
      const Eigen::MatrixXd weight = Eigen::MatrixXd::Constant(1, 1, 1.0 / sigma);
      problem.AddResidualBlock(new ceres::NormalPrior(weight, Eigen::VectorXd::Constant(1, length)), nullptr, &length);
      problem.SetParameterLowerBound(&length, 0, least);
    }
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.function_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  const OneThread one_thread;
  ceres::Solve(options, &problem, &summary);
}

/// From an observed joint with an unobserved parent up to the first below an observed joint or the root.
std::vector<int> UnobservedBonesTo(int end, const Skeleton& skeleton, const std::vector<bool>& seen) {
  std::vector<int> bones;
  for (int at = end; skeleton.joints[at].parent >= 0 && (at == end || !seen[at]); at = skeleton.joints[at].parent)
    bones.push_back(at);
  return bones;
}

/// Observed joints from which bones continue, and where the bones start from each.
std::vector<std::pair<int, Vector3d>> ObservedAbove(const std::vector<int>& unobserved_bones, const Skeleton& skeleton,
                                                    const std::vector<bool>& seen, const BoneEstimate& bones) {
  const int above = skeleton.joints[unobserved_bones.back()].parent;
  if (seen[above]) return {{above, Vector3d::Zero()}};
  std::vector<std::pair<int, Vector3d>> beside;
  for (int joint = 1; joint < skeleton.joint_count(); ++joint) {
    if (unobserved_bones.size() == 1 || skeleton.joints[joint].parent != above || !seen[joint]) continue;
    beside.emplace_back(joint, -bones.length[joint] * Direction(skeleton, joint));
  }
  return beside;
}

constexpr double kDistanceSigma = 0.002;  ///< m, standard deviation of a distance between two ends, at least

/// Fits chains of bones between an observed joint and the nearest observed one below over unobserved joints, none of
/// which swings (an arm that hangs all the time is as stiff as a trunk). Where the distance hardly changes, it fixes
/// the lengths of the rest pose. Without that, unobserved joints would fold between observed ones, or stretch. Trunks
/// that bend more get a lower weight.
void FitUnobservedChains(const std::vector<SkeletonTracks>& clips, const std::vector<double>& white,
                         const Skeleton& skeleton, const std::vector<bool>& seen, BoneEstimate& bones) {
  /// Share of the distance: standard deviation over frames without noise, at most, of a stiff chain.
  constexpr double kStiff = 0.06;
  const double noise = 2.0 * Square(MeanMedian(white));
  const std::vector<bool> swings = SwingingJoints(skeleton);
  std::vector<std::vector<double>> ratios(skeleton.joints.size());
  std::vector<Span> chains;
  for (int end = 1; end < skeleton.joint_count(); ++end) {
    if (!seen[end] || seen[skeleton.joints[end].parent]) continue;
    const std::vector<int> chain = UnobservedBonesTo(end, skeleton, seen);
    if (std::any_of(chain.begin() + 1, chain.end(), [&](int joint) { return swings[joint]; })) continue;
    const bool trunk = skeleton.joints[chain.back()].mirror == chain.back();
    for (const auto& [above, start] : ObservedAbove(chain, skeleton, seen, bones)) {
      const BoneDistance distance = DistanceOver(clips, white, end, above);
      if (distance.samples == 0) continue;
      const double bend = std::sqrt(std::max(0.0, Square(distance.sigma) - noise));
      const bool stiff = bend <= kStiff * distance.length;
      if (!stiff && !trunk) continue;
      // A tracker's point in the trunk may be higher or lower than the trunk's top suggests: weighted by sigma.
      chains.push_back({chain, {}, distance.length, std::max(kDistanceSigma, bend), start});
      for (const int bone : chain) chains.back().directions.push_back(Direction(skeleton, bone));
      Vector3d rest = Vector3d::Zero();
      for (const int bone : chain) rest += skeleton.joints[bone].rest_offset;
      if (!stiff || !start.isZero() || rest.norm() < 1e-6) continue;
      for (const int bone : chain) ratios[bone].push_back(distance.length / rest.norm());
    }
  }
  for (std::size_t j = 0; j < ratios.size(); ++j) {
    if (ratios[j].empty()) continue;
    double sum = 0.0;
    for (const double ratio : ratios[j]) sum += ratio;
    bones.length[j] = skeleton.joints[j].rest_offset.norm() * sum / static_cast<double>(ratios[j].size());
  }
  constexpr double kPriorShare = 0.25;  ///< share of a bone: standard deviation of its prior, and its least length
  FitLengths(
      chains, [](double length) { return std::pair(std::max(1e-3, kPriorShare * length), kPriorShare * length); },
      bones);
}

/// Lengths of bones that start at one unobserved joint, from the distances |b_i u_i - b_k u_k| between their observed
/// ends.
void SolveSiblings(const std::vector<SkeletonTracks>& clips, const std::vector<double>& white, const Skeleton& skeleton,
                   const std::vector<int>& siblings, BoneEstimate& bones) {
  /// Metres: standard deviation of the prior on the length of a bone, and its least length.
  constexpr std::pair<double, double> kPrior = {0.02, 1e-3};
  std::vector<Span> spans;
  for (std::size_t i = 0; i < siblings.size(); ++i) {
    for (std::size_t k = i + 1; k < siblings.size(); ++k) {
      const int a = siblings[i], b = siblings[k];
      const BoneDistance seen = DistanceOver(clips, white, a, b);
      if (seen.samples == 0) continue;
      spans.push_back({{a, b}, {Direction(skeleton, a), -Direction(skeleton, b)}, seen.length, kDistanceSigma});
      for (const int bone : {a, b}) bones.samples[bone] = std::max(bones.samples[bone], seen.samples);
    }
  }
  FitLengths(
      spans, [=](double) { return kPrior; }, bones);
}

/// Averages the two sides' lengths, weighted by `weight` (J).
void MakeSymmetric(const Skeleton& skeleton, const std::vector<double>& weight, std::vector<double>& length) {
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    const int partner = skeleton.joints[j].mirror;
    if (partner <= j) continue;
    const double total = weight[j] + weight[partner];
    const double share = total > 0.0 ? weight[j] / total : 0.5;
    length[j] = length[partner] = share * length[j] + (1.0 - share) * length[partner];
  }
}

}  // namespace

BoneEstimate EstimateBoneLengths(const std::vector<SkeletonTracks>& clips, const Skeleton& skeleton, bool symmetric) {
  const int joints = skeleton.joint_count();
  std::vector<double> white;
  for (const SkeletonTracks& clip : clips) white.push_back(EstimateNoise(clip, {}).white);
  std::vector<bool> seen = ShownJoints(clips);
  seen.resize(joints, false);
  BoneEstimate bones;
  bones.length = skeleton.RestBoneLengths();
  bones.samples.assign(joints, 0);
  bones.sigma.assign(joints, 0.0);
  std::vector<double> ratios;
  for (int j = 1; j < joints; ++j) {
    const BoneDistance distance = DistanceOver(clips, white, j, skeleton.joints[j].parent);
    bones.samples[j] = distance.samples;
    if (distance.samples == 0) continue;
    const double rest = bones.length[j];
    bones.length[j] = distance.length;
    bones.sigma[j] = distance.sigma;
    if (rest > 0.1) ratios.push_back(distance.length / rest);
  }
  if (!ratios.empty()) bones.scale = MeanMedian(ratios);
  for (int j = 1; j < joints; ++j) {
    if (bones.samples[j] == 0) bones.length[j] *= bones.scale;
  }
  const std::vector<std::vector<int>> children = skeleton.Children();
  for (int parent = 0; parent < joints; ++parent) {
    if (seen[parent]) continue;
    std::vector<int> siblings;
    for (const int child : children[parent]) {
      if (seen[child]) siblings.push_back(child);
    }
    if (siblings.size() >= 2) SolveSiblings(clips, white, skeleton, siblings, bones);
  }
  FitUnobservedChains(clips, white, skeleton, seen, bones);
  if (symmetric) {
    const std::vector<double> weight(bones.samples.begin(), bones.samples.end());
    MakeSymmetric(skeleton, weight, bones.length);
  }
  return bones;
}

}  // namespace mocurate
