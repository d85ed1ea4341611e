#include "fitting/uncertainty/variance_inflation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/median.h"
#include "fitting/terms/huber.h"

namespace mocurate {
namespace {

/// Gaps beyond which people move farther than a random walk. Source: bench_studio_fits gap=SECONDS
constexpr double kLongGap_s = 0.6;
constexpr double kMaxInflation = 4.0;  ///< factor on sigma, at most. Source: bench_studio_fits gap=SECONDS

/// Inflation of a joint's variance, (F).
std::vector<double> InflationOf(const SkeletonTracks& tracks, int joint) {
  const int frames = tracks.frames();
  std::vector<double> factors(static_cast<std::size_t>(frames), 1.0);
  for (int begin = 0; begin < frames; ++begin) {
    if (tracks.seen(begin, joint)) continue;
    int end = begin;
    while (end < frames && !tracks.seen(end, joint)) ++end;
    double length_s = tracks.time_s[std::min(end, frames - 1)] - tracks.time_s[std::max(begin - 1, 0)];
    if (begin == 0 || end == frames) length_s *= 2.0;  // its other end is unknown
    const double factor = std::clamp(length_s / kLongGap_s, 1.0, kMaxInflation);
    std::fill(factors.begin() + begin, factors.begin() + end, factor * factor);
    begin = end;
  }
  return factors;
}

}  // namespace

GapInflation FindGapInflation(const SkeletonTracks& tracks) {
  const auto joints = static_cast<std::size_t>(tracks.joints());
  const std::vector<bool> ever = tracks.JointObservations();
  GapInflation inflation;
  inflation.position.assign(tracks.confidence.size(), 1.0);
  inflation.rotation.assign(tracks.confidence.size(), std::numeric_limits<double>::infinity());
  for (int j = tracks.joints() - 1; j >= 0; --j) {
    if (!ever[j]) continue;
    const std::vector<double> own = InflationOf(tracks, j);
    for (std::size_t f = 0; f < own.size(); ++f) inflation.position[f * joints + j] = own[f];
  }
  for (int j = tracks.joints() - 1; j > 0; --j) {
    const int parent = tracks.skeleton->joints[j].parent;
    for (std::size_t f = 0; f < inflation.position.size() / joints; ++f) {
      const double& below = inflation.rotation[f * joints + j];
      double& above = inflation.rotation[f * joints + parent];
      above = std::min({above, below, ever[j] ? inflation.position[f * joints + j] : above});
    }
  }
  for (int j = 0; j < tracks.joints(); ++j) {  // a joint never observed follows those above or below
    const int parent = tracks.skeleton->joints[j].parent;
    for (std::size_t at = j; !ever[j] && at < inflation.position.size(); at += joints) {
      const double above = parent < 0 ? inflation.rotation[at] : inflation.position[at + parent - j];
      inflation.position[at] = std::min(above, inflation.rotation[at]);
    }
  }
  for (double& factor : inflation.rotation) {
    if (factor == std::numeric_limits<double>::infinity()) factor = 1.0;
  }
  return inflation;
}

namespace {

constexpr double kWhite = 0.1;      ///< autocorrelation of neighbours up to which noise counts as white
constexpr double kGross = 4.5;      ///< times the median departure: clamped there
constexpr double kMostLags = 60.0;  ///< frames of lag, at most (numerical)

/// Departures of each observed bone from the body's length, frame by frame; 0 where unobserved. Gross ones are clamped.
/// They are not centred on the clip: a departure that lasts for the whole clip is a slow error of the tracker, or of
/// the body, and averaging over frames reduces neither.
std::vector<std::vector<double>> DeparturesOfBones(const TrackProblem& whole) {
  std::vector<std::vector<double>> departures;
  std::vector<double> sizes;
  for (int j = 0; j < whole.tracks.joints(); ++j) {
    const int parent = whole.tracks.skeleton->joints[j].parent;
    if (parent < 0) continue;
    std::vector<double> of_bone(static_cast<std::size_t>(whole.frames()), 0.0);
    for (int f = 0; f < whole.frames(); ++f) {
      if (!whole.tracks.seen(f, j) || !whole.tracks.seen(f, parent)) continue;
      const Vector3d bone = whole.tracks.positions.at(f, j) - whole.tracks.positions.at(f, parent);
      of_bone[f] = bone.norm() - *whole.state.bone(j);
      sizes.push_back(std::abs(of_bone[f]));
    }
    departures.push_back(std::move(of_bone));
  }
  const double most = kGross * MeanMedian(sizes);
  for (std::vector<double>& of_bone : departures) {
    for (double& value : of_bone) value = std::clamp(value, -most, most);
  }
  return departures;
}

/// Mean product of departures that are `lag` frames apart.
double Product(const std::vector<std::vector<double>>& departures, int lag) {
  double sum = 0.0;
  double count = 0.0;
  for (const std::vector<double>& of_bone : departures) {
    for (std::size_t f = 0; f + lag < of_bone.size(); ++f) {
      if (of_bone[f] == 0.0 || of_bone[f + lag] == 0.0) continue;
      sum += of_bone[f] * of_bone[f + lag];
      count += 1.0;
    }
  }
  return count > 0.0 ? sum / count : 0.0;
}

}  // namespace

double AutocorrelationInflation(const TrackProblem& whole, double averaged) {
  const std::vector<std::vector<double>> departures = DeparturesOfBones(whole);
  const double square = Product(departures, 0);
  const double n = std::min(averaged, kMostLags);
  double growth = 1.0;
  for (int lag = 1; square > 0.0 && lag < n; ++lag) {
    const double correlation = Product(departures, lag) / square;
    if (correlation < kWhite) break;
    growth += 2.0 * (1.0 - lag / n) * correlation;
  }
  return growth;
}

namespace {

constexpr double kReach_s = 0.25;              ///< time before and after a frame over which residuals are averaged
constexpr int kMinAutocorrelationSamples = 4;  ///< samples in this time, at least
/// Chi square of three degrees of freedom that noise alone exceeds once in 1,000. Source: chi-square distribution
constexpr double kByNoise = 16.3;

/// Sums of a joint's samples up to a frame: precision, precision times departure, and count.
struct ResidualSums {
  Matrix3d information = Matrix3d::Zero();
  Vector3d pull = Vector3d::Zero();
  int count = 0;
};

/// (F+1) before each frame.
std::vector<ResidualSums> SumsOf(const TrackProblem& whole, int joint, double factor) {
  std::vector<ResidualSums> sums(static_cast<std::size_t>(whole.frames()) + 1);
  for (int f = 0; f < whole.frames(); ++f) {
    ResidualSums next = sums[f];
    if (whole.tracks.seen(f, joint)) {
      const Vector3d away = whole.tracks.positions.at(f, joint) - whole.state.position(f, joint);
      const Matrix3d information = whole.Information(f, joint) / factor;
      const Matrix3d robust = HuberSlope(away.dot(information * away), whole.huber) * information;
      next.information += robust;
      next.pull += robust * away;
      ++next.count;
    }
    sums[f + 1] = next;
  }
  return sums;
}

}  // namespace

std::vector<float> PersistentResidualCovariance(const TrackProblem& whole, double factor) {
  const std::vector<double>& time = whole.tracks.time_s;
  std::vector<float> covariance(6 * whole.tracks.confidence.size(), 0.0F);
  for (int j = 0; j < whole.tracks.joints(); ++j) {
    const std::vector<ResidualSums> sums = SumsOf(whole, j, factor);
    int begin = 0;
    int end = 0;
    for (int f = 0; f < whole.frames(); ++f) {
      while (time[begin] < time[f] - kReach_s) ++begin;
      while (end < whole.frames() && time[end] <= time[f] + kReach_s) ++end;
      if (sums[end].count - sums[begin].count < kMinAutocorrelationSamples) continue;
      const Vector3d pull = sums[end].pull - sums[begin].pull;
      const Eigen::LLT<Matrix3d> information(sums[end].information - sums[begin].information);
      if (information.info() != Eigen::Success) continue;
      const Vector3d mean = information.solve(pull);
      const double square = pull.dot(mean);
      if (square < kByNoise) continue;
      ToSixNumbers((1.0 - 3.0 / square) * mean * mean.transpose(), covariance.data() + 6 * whole.Index(f, j));
    }
  }
  return covariance;
}

}  // namespace mocurate
