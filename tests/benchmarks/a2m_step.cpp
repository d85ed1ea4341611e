// Action2Motion training as a run does it: batches of 128 windows of 60 frames from 1,191 clips with HumanAct12's
// sizes. Measures loader, forward, backward and Adam. Prints one JSON line in the format of the Python reference.
// Arguments: lie | plain [threads [shards [steps]]].

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/benchmarks/made_networks.h"
#include "train/trainer/trainer.h"

int main(int argc, char** argv) {
  using namespace mocurate;
  using Clock = std::chrono::steady_clock;
  const bool lie = argc < 2 || std::string(argv[1]) == "lie";
  const int threads = argc > 2 ? std::atoi(argv[2]) : 1;
  TrainingSet set;
  set.skeleton = benchmarks::HumanAct12Skeleton();
  for (int c = 0; c < 12; ++c) set.labels.push_back("label" + std::to_string(c));
  Random random(0, "benchmark");
  for (int i = 0; i < 1191; ++i) {
    TrainingSet::Clip clip;
    clip.id = std::to_string(i);
    clip.label = i % 12;
    clip.first = set.joints.size() / 72;
    clip.frames = 20 + static_cast<int>(random.Below(115));
    for (int k = 0; k < clip.frames * 72; ++k) set.joints.push_back(static_cast<float>(random.Uniform(-0.5, 0.5)));
    set.clips.push_back(clip);
  }
  NetworkOptions options(NetworkKind::kAction2Motion);
  options.action2motion.lie = lie;
  options.action2motion.time_counter = TimeChoice::kReleased;
  options.learning.shards = argc > 3 ? std::atoi(argv[3]) : threads;
  options.learning.iterations = 1 + (argc > 4 ? std::atoi(argv[4]) : 20);
  TrainingControl control;
  control.threads = threads;
  Clock::time_point begin;
  int steps = 0;
  control.progress = [&](double, const std::string&) {
    if (steps++ == 0) begin = Clock::now();  // the first step is a warm-up
  };
  if (!TrainNetwork(set, options, control)) return 1;
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count() / (steps - 1);
  std::printf(
      "{\"name\": \"a2m_step_%s\", \"seconds_median\": %.6f, \"items\": 128, \"unit\": \"sequences\", "
      "\"items_per_s\": %.3f, \"threads\": %d, \"shards\": %d}\n",
      lie ? "lie" : "plain", seconds, 128.0 / seconds, threads, static_cast<int>(options.learning.shards));
  return 0;
}
