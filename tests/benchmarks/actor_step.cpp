// Training steps of ACTOR or ST-GCN as a run does them: batches of 60 frames of 24 joints' rotations, 12 classes, the
// paper's sizes. Measures loader, forward, backward and AdamW. ACTOR's loss equals the Python reference's: rotation
// parameters per frame and KL. Prints one JSON line. Arguments: actor | joints (adds the loss on joints) | st_gcn
// [threads [shards [steps]]].

#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/benchmarks/made_networks.h"
#include "train/trainer/trainer.h"

int main(int argc, char** argv) {
  using namespace mocurate;
  using Clock = std::chrono::steady_clock;
  const std::string what = argc > 1 ? argv[1] : "actor";
  const int threads = argc > 2 ? std::atoi(argv[2]) : 1;
  TrainingSet set;
  set.skeleton = benchmarks::HumanAct12Skeleton();
  for (int c = 0; c < 12; ++c) set.labels.push_back("label" + std::to_string(c));
  Random random(0, "benchmark");
  for (int i = 0; i < 200; ++i) {
    TrainingSet::Clip clip;
    clip.id = std::to_string(i);
    clip.label = i % 12;
    clip.first = set.joints.size() / 72;
    clip.frames = 60 + static_cast<int>(random.Below(75));
    for (int k = 0; k < clip.frames * 72; ++k) set.joints.push_back(static_cast<float>(random.Uniform(-0.5, 0.5)));
    for (int k = 0; k < clip.frames * 24; ++k) {
      Quaterniond q(random.Normal() + 2.0, random.Normal(), random.Normal(), random.Normal());
      q.normalize();
      for (const double value : {q.w(), q.x(), q.y(), q.z()}) set.rotation.push_back(static_cast<float>(value));
    }
    for (const Joint& joint : set.skeleton->joints) clip.rest_offset.push_back(joint.rest_offset);
    set.clips.push_back(clip);
  }
  NetworkOptions options(what == "st_gcn" ? NetworkKind::kStGcn : NetworkKind::kActor);
  options.actor.joint_weight = what == "joints" ? 1.0 : 0.0;
  if (what != "st_gcn") options.learning.shards = argc > 3 ? std::atoi(argv[3]) : threads;
  const int wanted = argc > 4 ? std::atoi(argv[4]) : 6;
  options.learning.iterations = 1 + wanted;
  options.data.all_clips = true;
  options.recogniser.check_every = 100000;
  TrainingControl control;
  control.threads = threads;
  Clock::time_point begin;
  int steps = 0;
  double seconds = 0.0;
  control.progress = [&](double, const std::string&) {
    if (steps == 0) begin = Clock::now();  // the first step is a warm-up
    if (steps == wanted) seconds = std::chrono::duration<double>(Clock::now() - begin).count() / wanted;
    ++steps;
  };
  control.stop = [&] { return steps > wanted; };
  (void)TrainNetwork(set, options, control);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto batch = static_cast<double>(options.learning.batch);
  std::printf(
      "{\"name\": \"%s_step\", \"seconds_median\": %.6f, \"items\": %.0f, \"unit\": \"sequences\", \"items_per_s\": "
      "%.3f, "
      "\"threads\": %d, \"shards\": %d, \"peak_mb\": %.1f}\n",
      what.c_str(), seconds, batch, batch / seconds, threads, static_cast<int>(options.learning.shards),
      static_cast<double>(usage.ru_maxrss) / 1e3);
  return 0;
}
