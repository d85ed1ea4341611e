#include "fitting/solver/bone_lengths.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "fitting/evidence/noise.h"

namespace mocurate {
namespace {

constexpr double kMadToSigma = 1.4826;

/// Robust distance between two joints over all clips, noise removed. `samples` receives the number of frames.
struct Distance {
  double length = 0.0;
  double spread = 0.0;
  int samples = 0;
};

Distance DistanceBetween(const std::vector<SkeletonTracks>& clips, const std::vector<double>& white, int a, int b) {
  std::vector<double> lengths;
  double variance = 0.0;
  for (std::size_t c = 0; c < clips.size(); ++c) {
    for (int f = 0; f < clips[c].frames(); ++f) {
      if (!clips[c].seen(f, a) || !clips[c].seen(f, b)) continue;
      lengths.push_back((clips[c].positions.at(f, a) - clips[c].positions.at(f, b)).norm());
      variance += white[c] * white[c];
    }
  }
  Distance distance;
  distance.samples = static_cast<int>(lengths.size());
  if (lengths.empty()) return distance;
  variance /= static_cast<double>(lengths.size());
  const double median = Median(lengths);
  distance.length = std::sqrt(std::max(median * median - 4.0 * variance, 0.25 * median * median));
  for (double& length : lengths) length = std::abs(length - median);
  distance.spread = kMadToSigma * Median(lengths);
  return distance;
}

Vector3d Direction(const Skeleton& skeleton, int joint) {
  return skeleton.joints[joint].rest_offset.stableNormalized();
}

/// Lengths of bones that start at one unseen joint, from the distances between their seen ends: Gauss-Newton on
/// |b_i u_i - b_k u_k| = d_ik with prior b = scale * rest.
void SolveSiblings(const std::vector<SkeletonTracks>& clips, const std::vector<double>& white, const Skeleton& skeleton,
                   const std::vector<int>& siblings, double scale, BoneEstimate& bones) {
  constexpr double kDistanceSigma = 0.002;
  constexpr double kPriorSigma = 0.02;
  const auto count = static_cast<Eigen::Index>(siblings.size());
  for (int iteration = 0; iteration < 10; ++iteration) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(count, count) / (kPriorSigma * kPriorSigma);
    Eigen::VectorXd gradient(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double rest = scale * skeleton.joints[siblings[i]].rest_offset.norm();
      gradient[i] = (bones.length[siblings[i]] - rest) / (kPriorSigma * kPriorSigma);
    }
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index k = i + 1; k < count; ++k) {
        const Distance seen = DistanceBetween(clips, white, siblings[i], siblings[k]);
        const Vector3d u = Direction(skeleton, siblings[i]);
        const Vector3d v = Direction(skeleton, siblings[k]);
        const Vector3d between = bones.length[siblings[i]] * u - bones.length[siblings[k]] * v;
        if (seen.samples == 0 || between.norm() < 1e-6) continue;
        Eigen::VectorXd row = Eigen::VectorXd::Zero(count);
        row[i] = between.normalized().dot(u);
        row[k] = -between.normalized().dot(v);
        normal += row * row.transpose() / (kDistanceSigma * kDistanceSigma);
        gradient += row * (between.norm() - seen.length) / (kDistanceSigma * kDistanceSigma);
        if (iteration == 0) {
          bones.samples[siblings[i]] = std::max(bones.samples[siblings[i]], seen.samples);
          bones.samples[siblings[k]] = std::max(bones.samples[siblings[k]], seen.samples);
        }
      }
    }
    const Eigen::VectorXd step = normal.ldlt().solve(gradient);
    for (Eigen::Index i = 0; i < count; ++i) {
      bones.length[siblings[i]] = std::max(bones.length[siblings[i]] - step[i], 1e-3);
    }
  }
}

}  // namespace

void MakeSymmetric(const Skeleton& skeleton, const std::vector<double>& weight, std::vector<double>& length) {
  for (int j = 1; j < skeleton.joint_count(); ++j) {
    const int partner = skeleton.joints[j].mirror;
    if (partner <= j) continue;
    const double total = weight[j] + weight[partner];
    const double share = total > 0.0 ? weight[j] / total : 0.5;
    length[j] = length[partner] = share * length[j] + (1.0 - share) * length[partner];
  }
}

BoneEstimate EstimateBoneLengths(const std::vector<SkeletonTracks>& clips, const Skeleton& skeleton, bool symmetric) {
  const int joints = skeleton.joint_count();
  std::vector<double> white;
  std::vector<bool> seen(joints, false);
  for (const SkeletonTracks& clip : clips) {
    white.push_back(EstimateNoise(clip, {}).white);
    const std::vector<bool> in_clip = clip.SeenJoints();
    for (int j = 0; j < joints; ++j) seen[j] = seen[j] || in_clip[j];
  }
  BoneEstimate bones;
  bones.length = skeleton.RestBoneLengths();
  bones.samples.assign(joints, 0);
  bones.spread.assign(joints, 0.0);
  std::vector<double> ratios;
  for (int j = 1; j < joints; ++j) {
    const Distance distance = DistanceBetween(clips, white, j, skeleton.joints[j].parent);
    bones.samples[j] = distance.samples;
    if (distance.samples == 0) continue;
    const double rest = bones.length[j];
    bones.length[j] = distance.length;
    bones.spread[j] = distance.spread;
    if (rest > 0.1) ratios.push_back(distance.length / rest);
  }
  if (!ratios.empty()) bones.scale = Median(ratios);
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
    if (siblings.size() >= 2) SolveSiblings(clips, white, skeleton, siblings, bones.scale, bones);
  }
  if (symmetric) {
    const std::vector<double> weight(bones.samples.begin(), bones.samples.end());
    MakeSymmetric(skeleton, weight, bones.length);
  }
  return bones;
}

}  // namespace mocurate
