// bench_held_out SOURCE SKELETON [CLIPS [OPTION=NUMBER ...]]: hides 5 % of the joint observations of a real set in runs
// of 1 to 10 frames, fits the rest and predicts what was hidden. Distances are to the hidden observations, noise
// included, beside interpolation in time. Options: rotation_walk, velocity_walk, walk_refits, rest_spread,
// huber_sigmas.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Cholesky>

#include "core/base/random.h"
#include "fitting/fit_outcome.h"
#include "fitting/proportions.h"
#include "tests/benchmarks/real_people.h"

namespace mocurate {
namespace {

constexpr double kShare = 0.05;
constexpr int kLongestRun = 10;

struct Sample {
  int frame;
  int joint;
};

/// Hides runs of seen samples; every hidden one keeps seen samples of its joint before and after.
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

/// Neighbours of a hidden frame that are seen: two before, two after, -1 where there is none.
std::array<int, 4> Neighbours(const SkeletonTracks& tracks, const Sample& at) {
  std::array<int, 4> found{-1, -1, -1, -1};
  int f = at.frame;
  while (--f >= 0 && found[0] < 0) {
    if (tracks.seen(f, at.joint)) (found[1] < 0 ? found[1] : found[0]) = f;
  }
  f = at.frame;
  while (++f < tracks.frames() && found[3] < 0) {
    if (tracks.seen(f, at.joint)) (found[2] < 0 ? found[2] : found[3]) = f;
  }
  return found;
}

Vector3d Linear(const SkeletonTracks& tracks, const Sample& at) {
  const auto near = Neighbours(tracks, at);
  const double t0 = tracks.time_s[near[1]];
  const double a = (tracks.time_s[at.frame] - t0) / (tracks.time_s[near[2]] - t0);
  return (1.0 - a) * tracks.positions.at(near[1], at.joint) + a * tracks.positions.at(near[2], at.joint);
}

/// Cubic through the two seen samples on either side (Lagrange); linear where there are not two.
Vector3d Cubic(const SkeletonTracks& tracks, const Sample& at) {
  const auto near = Neighbours(tracks, at);
  if (near[0] < 0 || near[3] < 0) return Linear(tracks, at);
  Vector3d sum = Vector3d::Zero();
  for (const int a : near) {
    double weight = 1.0;
    for (const int b : near) {
      if (b != a) weight *= (tracks.time_s[at.frame] - tracks.time_s[b]) / (tracks.time_s[a] - tracks.time_s[b]);
    }
    sum += weight * tracks.positions.at(a, at.joint);
  }
  return sum;
}

void Print(const char* name, std::vector<double>& errors) {
  std::sort(errors.begin(), errors.end());
  std::printf("%-8s median %6.1f mm   p95 %6.1f mm\n", name, 1e3 * errors[errors.size() / 2],
              1e3 * errors[errors.size() * 95 / 100]);
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  if (argc < 3) return std::fprintf(stderr, "bench_held_out SOURCE SKELETON [CLIPS [OPTION=NUMBER ...]]\n"), 2;
  const auto skeleton = LoadSkeleton(argv[2]);
  if (!skeleton) return std::fprintf(stderr, "%s\n", skeleton.error().Message().c_str()), 1;
  JointTrackOptions options;
  options.solver = TrackSolver::kBanded;
  for (int i = 4; i < argc; ++i) {
    const std::string text = argv[i];
    const double value = std::atof(text.substr(text.find('=') + 1).c_str());
    const std::string name = text.substr(0, text.find('='));
    if (name == "rotation_walk") options.rotation_walk = value;
    if (name == "velocity_walk") options.velocity_walk = value;
    if (name == "rest_spread") options.rest_spread = value;
    if (name == "huber_sigmas") options.huber_sigmas = value;
    if (name == "walk_refits") options.steps = StepsWithRefits(static_cast<int>(value));
  }
  std::vector<double> fitted, linear, cubic;
  int one = 0;
  int two = 0;
  for (auto& [person, clips] : ReadPeople(argv[1], *skeleton, argc > 3 ? std::atoi(argv[3]) : 60)) {
    std::vector<SkeletonTracks> all;
    for (const RealClip& clip : clips) all.push_back(clip.tracks);
    const auto bones = EstimateProportions(all, *skeleton, ProportionsOptions{});
    if (!bones) continue;
    for (const RealClip& clip : clips) {
      const SkeletonTracks& whole = clip.tracks;
      SkeletonTracks tracks = whole;
      const std::vector<Sample> hidden = Hide(tracks, clip.id);
      const FrameRate rate = FrameRate::FromHz(1.0 / (tracks.time_s[1] - tracks.time_s[0]));
      const auto fit = RepairAndFit(tracks, rate, bones->bone_length, RepairOptions{}, options);
      if (!fit) continue;
      for (const Sample& at : hidden) {
        const Vector3d truth = whole.positions.at(at.frame, at.joint);
        const Vector3d error = fit->motion.joints.at(at.frame, at.joint) - truth;
        fitted.push_back(error.norm());
        linear.push_back((Linear(tracks, at) - truth).norm());
        cubic.push_back((Cubic(tracks, at) - truth).norm());
        const float* c =
            fit->motion.position_cov.data() + 6 * (static_cast<std::size_t>(at.frame) * tracks.joints() + at.joint);
        Matrix3d covariance;
        covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
        covariance.diagonal().array() += fit->variance_factor * fit->noise_sigma * fit->noise_sigma;
        const Eigen::LLT<Matrix3d> root(covariance);
        const Vector3d white = root.matrixL().solve(error);
        one += static_cast<int>((white.array().abs() < 1.0).count());
        two += static_cast<int>((white.array().abs() < 2.0).count());
      }
    }
  }
  if (fitted.empty()) return std::fprintf(stderr, "nothing was hidden\n"), 1;
  std::printf("%s: %zu observations hidden\n", argv[1], fitted.size());
  Print("fit", fitted);
  Print("linear", linear);
  Print("cubic", cubic);
  std::printf("stated sigma covers %.1f %% (68.3), twice sigma %.1f %% (95.4)\n", 100.0 * one / (3.0 * fitted.size()),
              100.0 * two / (3.0 * fitted.size()));
}
