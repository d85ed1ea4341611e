#include "fitting/evidence/outliers.h"

#include <algorithm>

#include "core/base/median.h"

namespace mocurate {
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
