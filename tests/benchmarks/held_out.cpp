// bench_held_out SOURCE SKELETON [CLIPS [OPTION=NUMBER ...]]: hides 5 % of the joint observations of a real set in runs
// of 1 to 10 frames, fits the rest and predicts the hidden ones. Distances are to the hidden observations, noise
// included, with interpolation in time for comparison. A tracker's error is autocorrelated: `body` is the fitted body's
// joint. `body + autocorrelated error` adds the residuals around the gap, predicted by their autocorrelation over one
// and two frames. That is the expected observation. `seen` is the body's distance from the observations it was fitted
// to. `|` rows are those of docs/refitted_sets.md. Options: noise (m, of sets that provide motion),
// rotation_process_noise, velocity_process_noise, walk_refits, rest_sigma, huber_share.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/base/random.h"
#include "fitting/fit_outcome.h"
#include "fitting/proportions.h"
#include "tests/benchmarks/clip_lines.h"
#include "tests/benchmarks/given_numbers.h"
#include "tests/benchmarks/options_without.h"
#include "tests/benchmarks/real_people.h"

namespace mocurate {
namespace {

constexpr double kShare = 0.05;
constexpr int kLongestRun = 10;

struct Sample {
  int frame;
  int joint;
};

/// Hides runs of observed samples; each keeps observed samples of its joint before and after.
std::vector<Sample> Hide(SkeletonTracks& tracks, const std::string& item) {
  std::vector<Sample> hidden;
  Random random(1, "held out", item);
  for (int j = 0; j < tracks.joints(); ++j) {
    for (int f = 1; f + kLongestRun + 1 < tracks.frames(); ++f) {
      if (random.Uniform() >= kShare / (0.5 * (kLongestRun + 1))) continue;
      const int run = 1 + static_cast<int>(random.Below(kLongestRun));
      if (!tracks.seen(f - 1, j) || !tracks.seen(f + run, j)) continue;
      for (int g = f; g < f + run; ++g) {
        if (!tracks.seen(g, j)) continue;
        hidden.push_back({g, j});
        tracks.confidence[static_cast<std::size_t>(g) * tracks.joints() + j] = 0.0;
      }
      f += run + 1;
    }
  }
  return hidden;
}

/// Frames nearest to a hidden one in which its joint is observed, in order of time: at most `each` on either side.
std::vector<int> Neighbours(const SkeletonTracks& tracks, const Sample& at, int each) {
  std::vector<int> found;
  for (int f = at.frame - 1; f >= 0 && static_cast<int>(found.size()) < each; --f) {
    if (tracks.seen(f, at.joint)) found.insert(found.begin(), f);
  }
  const auto before = static_cast<int>(found.size());
  for (int f = at.frame + 1; f < tracks.frames() && static_cast<int>(found.size()) < before + each; ++f) {
    if (tracks.seen(f, at.joint)) found.push_back(f);
  }
  return found;
}

Vector3d Linear(const SkeletonTracks& tracks, const Sample& at) {
  const std::vector<int> near = Neighbours(tracks, at, 1);
  const double t0 = tracks.time_s[near[0]];
  const double a = (tracks.time_s[at.frame] - t0) / (tracks.time_s[near[1]] - t0);
  return (1.0 - a) * tracks.positions.at(near[0], at.joint) + a * tracks.positions.at(near[1], at.joint);
}

/// Natural cubic spline through the six observed samples on either side: farther ones move the middle by less than
/// 1e-3.
Vector3d Spline(const SkeletonTracks& tracks, const Sample& at) {
  const std::vector<int> knots = Neighbours(tracks, at, 6);
  const auto count = static_cast<int>(knots.size());
  if (count < 3) return Linear(tracks, at);
  const auto time = [&](int i) { return tracks.time_s[knots[i]]; };
  const auto value = [&](int i) { return Vector3d(tracks.positions.at(knots[i], at.joint)); };
  Eigen::MatrixXd system = Eigen::MatrixXd::Identity(count, count);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, 3);
  for (int i = 1; i + 1 < count; ++i) {
    const double before = time(i) - time(i - 1);
    const double after = time(i + 1) - time(i);
    system.row(i).segment<3>(i - 1) << before / 6.0, (before + after) / 3.0, after / 6.0;
    right.row(i) = ((value(i + 1) - value(i)) / after - (value(i) - value(i - 1)) / before).transpose();
  }
  const Eigen::MatrixXd bend = system.partialPivLu().solve(right);
  int i = 0;
  while (knots[i + 1] < at.frame) ++i;
  const double width = time(i + 1) - time(i);
  const double b = (tracks.time_s[at.frame] - time(i)) / width;
  const double a = 1.0 - b;
  const Vector3d low = bend.row(i).transpose();
  const Vector3d high = bend.row(i + 1).transpose();
  return a * value(i) + b * value(i + 1) + width * width / 6.0 * ((a * a * a - a) * low + (b * b * b - b) * high);
}

/// Residuals of observations: autocorrelated variance per axis, its factor per frame, and white variance.
struct Residuals {
  double correlated = 0.0;
  double white = 0.0;
  double factor = 0.0;
};

Residuals ResidualsOf(const SkeletonTracks& tracks, const JointPositions& body) {
  double sum[3] = {};
  double count[3] = {};
  for (int j = 0; j < tracks.joints(); ++j) {
    for (int f = 0; f < tracks.frames(); ++f) {
      for (int lag = 0; lag < 3 && f + lag < tracks.frames(); ++lag) {
        if (!tracks.seen(f, j) || !tracks.seen(f + lag, j)) continue;
        const Vector3d one = tracks.positions.at(f, j) - body.at(f, j);
        const Vector3d other = tracks.positions.at(f + lag, j) - body.at(f + lag, j);
        sum[lag] += one.dot(other) / 3.0;
        count[lag] += 1.0;
      }
    }
  }
  const double all = count[0] > 0.0 ? sum[0] / count[0] : 0.0;
  if (!(count[2] > 0.0) || !(sum[1] > 0.0) || !(sum[2] > 0.0)) return {0.0, all, 0.0};
  const double one = sum[1] / count[1];
  const double factor = std::min(0.995, sum[2] / count[2] / one);
  const double correlated = std::min(one / factor, all);
  return {correlated, all - correlated, factor};
}

/// Prediction of the residual in a gap from those around it: mean, and remaining variance per axis.
struct Prediction {
  Vector3d mean = Vector3d::Zero();
  double variance = 0.0;
};

Prediction ExpectedResidual(const SkeletonTracks& tracks, const JointPositions& body, const Sample& at,
                            const Residuals& noise) {
  const std::vector<int> near = Neighbours(tracks, at, 3);
  const auto count = static_cast<int>(near.size());
  Eigen::MatrixXd covariance(count, count);
  Eigen::VectorXd shared(count);
  Eigen::MatrixXd observed(count, 3);
  for (int a = 0; a < count; ++a) {
    shared[a] = noise.correlated * std::pow(noise.factor, std::abs(near[a] - at.frame));
    observed.row(a) = (tracks.positions.at(near[a], at.joint) - body.at(near[a], at.joint)).transpose();
    for (int b = 0; b < count; ++b) {
      covariance(a, b) = noise.correlated * std::pow(noise.factor, std::abs(near[a] - near[b]));
      if (a == b) covariance(a, b) += noise.white + 1e-12;
    }
  }
  const Eigen::VectorXd weights = covariance.llt().solve(shared);
  return {observed.transpose() * weights, noise.correlated - shared.dot(weights) + noise.white};
}

/// Shares of whitened components within one and two standard deviations.
struct Cover {
  double one = 0.0, two = 0.0, count = 0.0;
  void Add(const Matrix3d& covariance, const Vector3d& error) {
    const Vector3d white = Eigen::LLT<Matrix3d>(covariance).matrixL().solve(error);
    one += static_cast<double>((white.array().abs() < 1.0).count());
    two += static_cast<double>((white.array().abs() < 2.0).count());
    count += 3.0;
  }
  void Add(const Cover& other) { one += other.one, two += other.two, count += other.count; }
};

std::string Cell(std::vector<double>& errors) {
  std::sort(errors.begin(), errors.end());
  char text[64];
  std::snprintf(text, sizeof(text), "%.1f / %.1f", 1e3 * errors[errors.size() / 2],
                1e3 * errors[errors.size() * 95 / 100]);
  return text;
}

struct Score {
  std::vector<double> body, expected, linear, spline, seen;
  Cover cover_body, cover_expected;
  nlohmann::json outcome;  ///< of one clip

  void Add(const Score& other) {
    for (auto part : {&Score::body, &Score::expected, &Score::linear, &Score::spline, &Score::seen})
      (this->*part).insert((this->*part).end(), (other.*part).begin(), (other.*part).end());
    cover_body.Add(other.cover_body);
    cover_expected.Add(other.cover_expected);
  }
};

double Middle(std::vector<double> errors) {
  std::sort(errors.begin(), errors.end());
  return errors[errors.size() / 2];
}

void Add(const RealClip& clip, const std::vector<double>& bones, const JointTrackOptions& options,
         const RepairOptions& repair, Score& score) {
  const SkeletonTracks& whole = clip.tracks;
  SkeletonTracks tracks = whole;
  const std::vector<Sample> hidden = Hide(tracks, clip.id);
  const auto fit = RepairAndFit(tracks, clip.rate, bones, repair, options);
  if (!fit) return;
  score.outcome = benchmarks::OutcomeOf(*fit);
  const JointPositions& joints = fit->motion.joints;
  const Residuals noise = ResidualsOf(tracks, joints);
  for (int f = 0; f < tracks.frames(); ++f) {
    for (int j = 0; j < tracks.joints(); ++j) {
      if (tracks.seen(f, j)) score.seen.push_back((tracks.positions.at(f, j) - joints.at(f, j)).norm());
    }
  }
  for (const Sample& at : hidden) {
    const Vector3d truth = whole.positions.at(at.frame, at.joint);
    const Vector3d error = joints.at(at.frame, at.joint) - truth;
    const Prediction residual = ExpectedResidual(tracks, joints, at, noise);
    score.body.push_back(error.norm());
    score.expected.push_back((error + residual.mean).norm());
    score.linear.push_back((Linear(tracks, at) - truth).norm());
    score.spline.push_back((Spline(tracks, at) - truth).norm());
    const Matrix3d covariance = FromSixNumbers(fit->motion.position_cov.data() +
                                               6 * (static_cast<std::size_t>(at.frame) * tracks.joints() + at.joint));
    const double sigma = fit->noise_sigma / whole.confidence_at(at.frame, at.joint);
    score.cover_body.Add(covariance + fit->variance_factor * sigma * sigma * Matrix3d::Identity(), error);
    score.cover_expected.Add(covariance + residual.variance * Matrix3d::Identity(), error + residual.mean);
  }
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  if (argc < 3) return std::fprintf(stderr, "bench_held_out SOURCE SKELETON [CLIPS [OPTION=NUMBER ...]]\n"), 2;
  const auto skeleton = LoadSkeleton(argv[2]);
  if (!skeleton) return std::fprintf(stderr, "%s\n", skeleton.error().Message().c_str()), 1;
  const FittingOptions given = benchmarks::OptionsWithout();
  JointTrackOptions options = given.joint_tracks;
  options.solver = PoseSolver::kBanded;
  double noise = 0.03;
  for (const auto& [name, value] : GivenNumbers(argc, argv, 4)) {
    if (name == "noise") noise = value;
    if (name == "rotation_process_noise") options.priors.rotation_noise = value;
    if (name == "velocity_process_noise") options.priors.position_noise = value;
    if (name == "rest_sigma") options.priors.rest = value;
    if (name == "contact_process_noise")
      options.contact_process_noise = value > 0.0 ? std::optional<double>(value) : std::nullopt;
    if (name == "huber_share") options.huber_share = value;
    if (name == "walk_refits") options.steps = StepsWithRefits(static_cast<int>(value));
  }
  Score score;
  benchmarks::ClipLines lines(argc, argv);
  for (auto& [person, clips] : ReadPeople(argv[1], *skeleton, argc > 3 ? std::atoi(argv[3]) : 60, noise)) {
    std::vector<SkeletonTracks> all;
    for (std::size_t i = 0; i < clips.size() && i < 30; ++i) all.push_back(clips[i].tracks);
    const auto bones = EstimateProportions(all, clips.front().tracks.skeleton, ProportionsOptions{});
    for (RealClip& clip : clips) clip.tracks = OnBody(std::move(clip.tracks), bones.skeleton);
    for (const RealClip& clip : clips) {
      Score own;
      Add(clip, bones.bone_length, options, given.repair, own);
      if (own.body.empty()) continue;
      lines.Add(clip.id, person, argv[1],
                {{"median_mm", 1e3 * Middle(own.body)},
                 {"within_one", own.cover_body.one / own.cover_body.count},
                 {"within_two", own.cover_body.two / own.cover_body.count}},
                own.outcome);
      score.Add(own);
    }
  }
  if (score.body.empty()) return std::fprintf(stderr, "nothing was hidden\n"), 1;
  const std::size_t hidden = score.body.size();
  const auto share = [](double part, const Cover& of) { return 100.0 * part / of.count; };
  std::printf("| %s | %zu | %s | %s | %s | %s | %s | %.1f, %.1f | %.1f, %.1f |\n", argv[1], hidden,
              Cell(score.seen).c_str(), Cell(score.body).c_str(), Cell(score.expected).c_str(),
              Cell(score.linear).c_str(), Cell(score.spline).c_str(), share(score.cover_body.one, score.cover_body),
              share(score.cover_body.two, score.cover_body), share(score.cover_expected.one, score.cover_expected),
              share(score.cover_expected.two, score.cover_expected));
}
