#include "fitting/evidence/noise.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/median.h"

namespace mocurate {
namespace {

/// m; below, data outweigh the priors so far that the solver converges slowly along undetermined directions (twist of
/// straight limbs). No tracker is more exact (numerical).
constexpr double kSmallestTrackSigma = 1e-3;
constexpr std::size_t kEnoughSamples = 10;  ///< samples for a standard deviation, at least
/// Bones, each with enough samples, for a noise estimate from lengths alone.
constexpr std::size_t kEnoughBones = 5;
/// Ratio of noise in bone lengths to departures from lines, below which there is fast motion. Bone lengths show
/// slightly less noise than there is; motion makes departures from lines much larger.
constexpr double kNoMotion = 0.8;
/// m; standard deviation of tracks too short to show their noise: a depth tracker's.
constexpr double kUnmeasuredSigma = 0.02;

/// Standard deviation from absolute departures, by their median. Gross errors beyond four standard deviations are
/// excluded.
double SigmaOf(std::vector<double> departures) {
  double sigma = kMadToSigma * MeanMedian(departures);
  for (int i = 0; i < 3; ++i) {
    const auto gross = [&](double departure) { return departure > 4.0 * sigma; };
    departures.erase(std::remove_if(departures.begin(), departures.end(), gross), departures.end());
    sigma = kMadToSigma * MeanMedian(departures);
  }
  return sigma;
}

/// Departures of frame f from the line between f-1 and f+1, whitened to the variance of a typical sample. Appends
/// three.
void AppendDepartures(const SkeletonTracks& tracks, int joint, std::vector<double>& departures) {
  for (int f = 1; f + 1 < tracks.frames(); ++f) {
    if (!tracks.seen(f - 1, joint) || !tracks.seen(f, joint) || !tracks.seen(f + 1, joint)) continue;
    const double a = (tracks.time_s[f] - tracks.time_s[f - 1]) / (tracks.time_s[f + 1] - tracks.time_s[f - 1]);
    const Vector3d line = (1.0 - a) * tracks.positions.at(f - 1, joint) + a * tracks.positions.at(f + 1, joint);
    const Matrix3d unit = UnitCovariance(tracks, f, joint) +
                          (1.0 - a) * (1.0 - a) * UnitCovariance(tracks, f - 1, joint) +
                          a * a * UnitCovariance(tracks, f + 1, joint);
    const Vector3d white = Eigen::LLT<Matrix3d>(unit).matrixL().solve(tracks.positions.at(f, joint) - line);
    for (int i = 0; i < 3; ++i) departures.push_back(std::abs(white[i]));
  }
}

/// Departures of a bone's length in frame f from the line between its lengths in f-1 and f+1, whitened to the variance
/// of a typical sample's axis. Motion, however fast, changes no bone.
void AppendBoneDepartures(const SkeletonTracks& tracks, int joint, std::vector<double>& departures) {
  const int parent = tracks.skeleton->joints[joint].parent;
  if (parent < 0) return;
  const auto length = [&](int f, double& variance) {
    if (!tracks.seen(f, joint) || !tracks.seen(f, parent)) return 0.0;
    const Vector3d bone = tracks.positions.at(f, joint) - tracks.positions.at(f, parent);
    const Vector3d along = bone.stableNormalized();
    variance = along.dot((UnitCovariance(tracks, f, joint) + UnitCovariance(tracks, f, parent)) * along);
    return bone.norm();
  };
  for (int f = 1; f + 1 < tracks.frames(); ++f) {
    double before_variance = 0.0, variance = 0.0, after_variance = 0.0;
    const double before = length(f - 1, before_variance), is = length(f, variance),
                 after = length(f + 1, after_variance);
    if (before == 0.0 || is == 0.0 || after == 0.0) continue;  // not observed, or at its parent's position
    const double a = (tracks.time_s[f] - tracks.time_s[f - 1]) / (tracks.time_s[f + 1] - tracks.time_s[f - 1]);
    const double whole = variance + (1.0 - a) * (1.0 - a) * before_variance + a * a * after_variance;
    if (whole > 0.0) departures.push_back(std::abs(is - (1.0 - a) * before - a * after) / std::sqrt(whole));
  }
}

/// Sigma per axis of the two ends of a bone, from its length. 0 with too few observations.
double BoneSigma(const SkeletonTracks& tracks, int joint, const std::vector<double>& bone_length) {
  const int parent = tracks.skeleton->joints[joint].parent;
  std::vector<double> lengths;
  std::vector<double> variances;  // of each length, in units of sigma^2
  for (int f = 0; parent >= 0 && f < tracks.frames(); ++f) {
    if (!tracks.seen(f, joint) || !tracks.seen(f, parent)) continue;
    const Vector3d bone = tracks.positions.at(f, joint) - tracks.positions.at(f, parent);
    if (bone.isZero(0.0)) continue;  // not observed: at its parent's position
    const Vector3d along = bone.stableNormalized();
    lengths.push_back(bone.norm());
    variances.push_back(along.dot((UnitCovariance(tracks, f, joint) + UnitCovariance(tracks, f, parent)) * along));
  }
  if (lengths.size() < kEnoughSamples) return 0.0;
  std::vector<double> departures = lengths;
  const double centre = bone_length.empty() ? MeanMedian(departures) : bone_length[joint];
  departures.clear();
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (variances[i] > 0.0) departures.push_back(std::abs(lengths[i] - centre) / std::sqrt(variances[i]));
  }
  return SigmaOf(std::move(departures));
}

}  // namespace

Matrix3d UnitCovariance(const SkeletonTracks& tracks, int frame, int joint) {
  if (tracks.precision.empty()) return Matrix3d::Identity();
  return tracks.precision_at(frame, joint).inverse();
}

NoiseEstimate EstimateNoise(const SkeletonTracks& tracks, const std::vector<double>& bone_length) {
  std::vector<double> all, of_bones;
  double bone_square = 0.0;
  int bones = 0;
  for (int j = 0; j < tracks.joints(); ++j) {
    AppendDepartures(tracks, j, all);
    AppendBoneDepartures(tracks, j, of_bones);
    const double bone = BoneSigma(tracks, j, bone_length);
    if (bone == 0.0) continue;
    bone_square += bone * bone;
    ++bones;
  }
  NoiseEstimate noise;
  noise.measured = bones > 0 || all.size() >= 3 * kEnoughSamples;
  noise.white = SigmaOf(std::move(all));
  // Fast motion departs from lines without any noise; noise shows in the bones too.
  const bool bones_suffice = of_bones.size() >= kEnoughBones * kEnoughSamples;
  const double most = bones_suffice ? SigmaOf(std::move(of_bones)) : noise.white;
  const double fast = most < kNoMotion * noise.white ? most / noise.white : 1.0;
  noise.white *= fast;
  if (!noise.measured) {
    noise.sigma = kUnmeasuredSigma;
    return noise;
  }
  noise.sigma = std::max(
      {noise.white, bones > 0 ? std::sqrt(bone_square / bones) : 0.0, kSmallestTrackSigma, tracks.least_sigma});
  return noise;
}

namespace {

constexpr double kOutlierReach_s = 0.12;   ///< time before and after a sample whose samples it is compared with
constexpr double kOutlierSigmas = 10.0;    ///< standard deviations from the line through the samples nearby
constexpr double kSmallestOutlier = 0.15;  ///< m from this line, at least
constexpr double kOutlierSteps = 1.5;      ///< factor on the steps nearby, added to the limit

/// The frame and the same number of frames on both sides in which the joint is observed, so that steady movement does
/// not shift the median.
std::vector<int> ObservedNearby(const SkeletonTracks& tracks, int frame, int joint) {
  const double time = tracks.time_s[frame];
  std::vector<int> before;
  std::vector<int> after;
  for (int f = frame - 1; f >= 0 && time - tracks.time_s[f] <= kOutlierReach_s; --f) {
    if (tracks.seen(f, joint)) before.push_back(f);
  }
  for (int f = frame + 1; f < tracks.frames() && tracks.time_s[f] - time <= kOutlierReach_s; ++f) {
    if (tracks.seen(f, joint)) after.push_back(f);
  }
  std::vector<int> nearby{frame};
  for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i) {
    nearby.push_back(before[i]);
    nearby.push_back(after[i]);
  }
  return nearby;
}

Vector3d MedianOver(const SkeletonTracks& tracks, const std::vector<int>& frames, int joint) {
  Vector3d median;
  for (int i = 0; i < 3; ++i) {
    std::vector<double> values;
    for (const int f : frames) values.push_back(tracks.positions.at(f, joint)[i]);
    median[i] = MeanMedian(values);
  }
  return median;
}

/// Median step of the joint between these frames, without `frame`: a hand that strikes out and returns is no outlier.
double StepNearby(const SkeletonTracks& tracks, std::vector<int> frames, int frame, int joint) {
  frames.erase(std::remove(frames.begin(), frames.end(), frame), frames.end());
  std::sort(frames.begin(), frames.end());
  std::vector<double> steps;
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
    const double step = (tracks.positions.at(frames[i + 1], joint) - tracks.positions.at(frames[i], joint)).norm();
    steps.push_back(frames[i] < frame && frame < frames[i + 1] ? 0.5 * step : step);
  }
  return MeanMedian(steps);
}

}  // namespace

Vector3d RunningMedian(const SkeletonTracks& tracks, int frame, int joint) {
  return MedianOver(tracks, ObservedNearby(tracks, frame, joint), joint);
}

double OutlierLimit(double sigma) { return std::max(kOutlierSigmas * sigma, kSmallestOutlier); }

std::vector<bool> RejectOutliers(SkeletonTracks& tracks, double sigma) {
  std::vector<bool> rejected(tracks.confidence.size(), false);
  const double allowed = OutlierLimit(sigma);
  for (int j = 0; j < tracks.joints(); ++j) {
    for (int f = 0; f < tracks.frames(); ++f) {
      if (!tracks.seen(f, j)) continue;
      const std::vector<int> nearby = ObservedNearby(tracks, f, j);
      if (nearby.size() < 3) continue;
      const Vector3d median = MedianOver(tracks, nearby, j);
      const Vector3d away = tracks.positions.at(f, j) - median;
      const double square = tracks.precision.empty() ? away.squaredNorm() : away.dot(tracks.precision_at(f, j) * away);
      if (square <= allowed * allowed) continue;
      if (away.norm() <= kSmallestOutlier + kOutlierSteps * StepNearby(tracks, nearby, f, j)) continue;
      rejected[static_cast<std::size_t>(f) * tracks.joints() + j] = true;
    }
  }
  for (std::size_t i = 0; i < rejected.size(); ++i) {
    if (rejected[i]) tracks.confidence[i] = 0.0;
  }
  return rejected;
}

}  // namespace mocurate
