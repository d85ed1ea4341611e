// Training steps of MACVAE as a run does them: batches of synthetic samples of 52 joints, placed and padded. Measures
// forward, losses on rotations, joints, acceleration and KL, backward and AdamW. Sizes and lengths equal the Python
// reference's. Prints one JSON line; peak memory is of the whole process. Arguments: reduced | full [batch [steps]].

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "train/trainer/trainer.h"

namespace mocurate {
namespace {

constexpr int kJoints = 52, kLabels = 12, kSamples = 200;
constexpr std::array<int, kJoints> kParents = {-1, 0,  0,  0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  9,  9,  12, 13, 14,
                                               16, 17, 18, 19, 20, 22, 23, 20, 25, 26, 20, 28, 29, 20, 31, 32, 20, 34,
                                               35, 21, 37, 38, 21, 40, 41, 21, 43, 44, 21, 46, 47, 21, 49, 50};

SkeletonPtr MadeSkeleton(Random& random) {
  auto skeleton = std::make_shared<Skeleton>();
  skeleton->name = "smplh";
  for (int j = 0; j < kJoints; ++j) {
    Joint joint;
    joint.name = j == 1 ? "left_hip" : j == 2 ? "right_hip" : "joint" + std::to_string(j);
    joint.parent = kParents[static_cast<std::size_t>(j)];
    if (j > 0) joint.rest_offset = 0.1 * Vector3d(random.Normal(), random.Normal(), random.Normal());
    joint.mirror = j;
    skeleton->joints.push_back(joint);
  }
  return skeleton;
}

/// A sample of [previous action, transition, action]: each component of rotation vector and position is a sine of time.
void AddSample(int index, int frames, Random& random, TrainingSet& set) {
  const auto between = [&random](int least, int below) {
    return least + static_cast<int>(random.Below(static_cast<std::uint32_t>(below - least)));
  };
  TrainingSet::Clip clip;
  clip.id = std::to_string(index);
  clip.label = index % kLabels;
  clip.parts = {between(5, frames / 3), between(3, frames / 6), between(8, frames / 3)};
  clip.word = {between(0, kLabels), kLabels, clip.label};
  clip.first = set.joints.size() / (3 * kJoints);
  clip.frames = clip.parts[0] + clip.parts[1] + clip.parts[2];
  std::array<double, 3 * kJoints> speed{}, phase{};
  for (double& value : speed) value = 3.0 * random.Uniform();
  for (double& value : phase) value = 6.0 * random.Uniform();
  for (int t = 0; t < clip.frames; ++t) {
    const double seconds = t / 20.0;
    for (std::size_t j = 0; j < kJoints; ++j) {
      Vector3d vector;
      for (std::size_t k = 0; k < 3; ++k) {
        vector[static_cast<Eigen::Index>(k)] = 0.5 * std::sin(speed[3 * j + k] * seconds + phase[3 * j + k]);
      }
      const Quaterniond q(Eigen::AngleAxisd(vector.norm(), vector.normalized()));
      for (const double value : {q.w(), q.x(), q.y(), q.z()}) set.rotation.push_back(static_cast<float>(value));
      for (std::size_t k = 0; k < 3; ++k) set.joints.push_back(static_cast<float>(std::sin(speed[k] * seconds / 3.0)));
    }
  }
  for (const Joint& joint : set.skeleton->joints) clip.rest_offset.push_back(joint.rest_offset);
  set.clips.push_back(std::move(clip));
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  using namespace mocurate;
  using Clock = std::chrono::steady_clock;
  const bool full = argc > 1 && std::string(argv[1]) == "full";
  const int batch = argc > 2 ? std::atoi(argv[2]) : full ? 4 : 16;
  const int wanted = argc > 3 ? std::atoi(argv[3]) : full ? 3 : 12;
  const int frames = full ? 120 : 60;
  Random random(0, "benchmark");
  TrainingSet set;
  set.skeleton = MadeSkeleton(random);
  for (int c = 0; c < kLabels; ++c) set.labels.push_back("label" + std::to_string(c));
  set.words = set.labels;
  set.words.emplace_back("transition");
  for (int i = 0; i < kSamples; ++i) AddSample(i, frames, random, set);
  NetworkOptions options(NetworkKind::kMacvae);
  options.macvae.points = PointChoice::kJoints;
  options.macvae.vocabulary = full ? 5396 : 60;
  options.data.frames = frames;
  options.data.all_clips = true;
  options.learning.batch = batch;
  options.learning.iterations = 1 + wanted;
  options.learning.save_every = 1000000;
  if (!full) {
    options.macvae.width = 128;
    options.macvae.layers = 2;
    options.macvae.feed_forward = 512;
  }
  TrainingControl control;
  control.threads = 1;
  Clock::time_point last;
  std::vector<double> seconds;
  bool warm = false;
  rusage usage{};
  control.progress = [&](double, const std::string&) {
    const Clock::time_point now = Clock::now();
    if (warm) seconds.push_back(std::chrono::duration<double>(now - last).count());
    warm = true;  // the first step is a warm-up
    last = now;
    getrusage(RUSAGE_SELF, &usage);  // before the checkpoint is written
  };
  control.stop = [] { return false; };
  const auto trained = TrainNetwork(set, options, control);
  if (!trained) {
    std::fprintf(stderr, "%s\n", trained.error().Message().c_str());
    return 1;
  }
  std::sort(seconds.begin(), seconds.end());
  const double median = seconds[seconds.size() / 2];
  std::printf(
      "{\"name\": \"macvae_step_%s\", \"seconds_median\": %.6f, \"seconds_min\": %.6f, \"repeats\": %d, \"items\": %d, "
      "\"unit\": \"sequences\", \"items_per_s\": %.3f, \"threads\": 1, \"peak_mb\": %.1f, \"loss_first\": %.9g, "
      "\"loss_last\": %.9g}\n",
      full ? "full" : "reduced", median, seconds.front(), wanted, batch, batch / median,
      static_cast<double>(usage.ru_maxrss) / 1e3, trained->history.at("loss").front(),
      trained->history.at("loss").back());
  return 0;
}
