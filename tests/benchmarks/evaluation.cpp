// Scores a row in one process, from dataset files to its figures; prints one JSON line.
//   evaluation given [repeats] [threads]     3,000 motions once, as given: features, logits, all metrics
//   evaluation released [repeats] [threads]  20 repetitions as the released code draws them, random hidden states:
//                                            reference, Real and one generator, 60 passes of 3,000 motions
//   evaluation cached [repeats]              the metrics of `released` with its features in the cache
//   evaluation fid [repeats]                 FID of two sets of 100,000 x 512 features
// The network is a GRU of the released shape (72 numbers, 2 x 128, 12 classes); motions are the rest pose with noise.

#include <stdlib.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

#include "core/store/feature_file.h"
#include "core/store/store.h"
#include "eval/metrics/feature_distances.h"
#include "eval/options.h"
#include "eval/protocols/score.h"
#include "eval/stages.h"
#include "tests/benchmarks/json_line.h"
#include "tests/benchmarks/made_networks.h"
#include "tests/train/chains.h"
#include "train/checkpoint/checkpoint.h"
#include "train/options.h"

namespace mocurate {
namespace {

constexpr int kClasses = 12;
constexpr int kFrames = 60;
constexpr int kMotions = 3000;
constexpr int kRepetitions = 20;

SkeletonPtr HumanAct12Skeleton() {
  auto skeleton = std::make_shared<Skeleton>();
  skeleton->name = "humanact12";
  skeleton->lie = HumanAct12Chains();
  for (int j = 0; j < 24; ++j) {
    Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.rest_offset = 0.3 * skeleton->lie->raw_offsets[static_cast<std::size_t>(j)];
    joint.mirror = j;
    skeleton->joints.push_back(joint);
  }
  const std::vector<int> parents = skeleton->LieParents();
  for (int j = 0; j < 24; ++j)
    skeleton->joints[static_cast<std::size_t>(j)].parent = parents[static_cast<std::size_t>(j)];
  return skeleton;
}

Dataset RandomDataset(const SkeletonPtr& skeleton, int clips) {
  Dataset dataset;
  dataset.skeleton = skeleton;
  dataset.joints_only = true;
  for (int c = 0; c < kClasses; ++c) dataset.labels.push_back("label" + std::to_string(10 + c));
  Random random(0, "dataset");
  for (int i = 0; i < clips; ++i) {
    Clip clip;
    clip.identity.source = "benchmark";
    clip.identity.recording = std::to_string(100000 + i);
    clip.identity.end_frame = kFrames;
    clip.label = dataset.labels[static_cast<std::size_t>(i % kClasses)];
    Motion motion;
    motion.skeleton = skeleton;
    motion.joints = JointPositions(kFrames, skeleton->joint_count());
    for (int f = 0; f < kFrames; ++f) {
      for (int j = 0; j < skeleton->joint_count(); ++j) {
        const Joint& joint = skeleton->joints[static_cast<std::size_t>(j)];
        Vector3d place = joint.rest_offset;
        if (joint.parent >= 0) place += motion.joints.at(f, joint.parent);
        for (int k = 0; k < 3; ++k) place[k] += random.Uniform(-0.05, 0.05);
        motion.joints.at(f, j) = place;
      }
    }
    clip.motion = std::move(motion);
    dataset.clips.push_back(std::move(clip));
  }
  return dataset;
}

Status WriteRecogniser(const SkeletonPtr& skeleton, const std::filesystem::path& path) {
  NetworkOptions options(NetworkKind::kGruRecogniser);
  options.data.input = RecogniserInputKind::kCrop;
  Checkpoint checkpoint;
  checkpoint.kind = kGruRecogniserKind;
  checkpoint.options = OptionsToJson(options);
  for (int c = 0; c < kClasses; ++c) checkpoint.labels.push_back("label" + std::to_string(10 + c));
  checkpoint.skeleton = skeleton;
  checkpoint.parameters = GruRecogniserParameters({});
  benchmarks::FillRandomly(checkpoint.parameters);
  return WriteCheckpoint(checkpoint, path);
}

/// The stages of a row, over files of a folder.
class Evaluation {
 public:
  Evaluation(std::filesystem::path folder, int threads) : folder_(std::move(folder)), threads_(threads) {
    const SkeletonPtr skeleton = HumanAct12Skeleton();
    Check(WriteDataset(RandomDataset(skeleton, kMotions), folder_ / "dataset.h5"));
    Check(WriteRecogniser(skeleton, folder_ / "recogniser.h5"));
  }

  void Features(const std::string& purpose, bool released) {
    FeaturesOptions options;
    options.generated = purpose == "generated";
    options.purpose = purpose;
    if (released) {
      options.passes = kRepetitions;
      options.motions = options.generated ? 0 : kMotions;
      options.hidden = HiddenDraw::kNormal;
      options.crop = CropDraw::kReleased;
    }
    StageRequest request;
    request.options = OptionsToJson(options);
    request.inputs = {{"weights", "recogniser", folder_ / "recogniser.h5", ""},
                      {"motions", "dataset", folder_ / "dataset.h5", ""}};
    request.output = folder_ / (purpose + ".h5");
    request.threads = threads_;
    Check(MakeFeaturesStage({})(request));
  }

  void Score(const std::string& purpose, bool released) {
    ScoreOptions options;
    options.name = purpose;
    options.real = purpose == "real" ? RealRow::kTrain : RealRow::kNone;
    if (released) options.draw.repetitions = kRepetitions;
    if (released) options.draw.motions = kMotions;
    StageRequest request;
    request.options = OptionsToJson(options);
    request.inputs = {{"row", purpose, folder_ / (purpose + ".h5"), ""},
                      {"reference_train", "reference", folder_ / "reference.h5", ""}};
    request.output = folder_ / "score.json";
    Check(ScoreStage(request));
  }

  int exit_code() const { return exit_code_; }

 private:
  template <class Result>
  void Check(const Result& result) {
    if (result) return;
    std::fprintf(stderr, "%s\n", result.error().Message().c_str());
    exit_code_ = 1;
  }

  std::filesystem::path folder_;
  int threads_;
  int exit_code_ = 0;
};

int FidOfManyFeatures(int repeats) {
  constexpr Eigen::Index kCount = 100000, kSize = 512;
  Features features(kCount, kSize);
  Random random(0, "features");
  for (Eigen::Index i = 0; i < features.size(); ++i) features.data()[i] = random.Uniform(-1.0, 1.0);
  const Features other = features.bottomRows(kCount - 1);
  double distance = 0.0;
  benchmarks::Report("fid_100000x512", 1, "distance", repeats, [&] {
    const auto a = StatisticsOf(features);
    const auto b = StatisticsOf(other);
    distance = *FrechetDistance(*a, *b);
  });
  return distance < 1.0 ? 0 : 1;
}

int Run(const std::string& what, int repeats, int threads, const std::filesystem::path& folder) {
  if (what == "fid") return FidOfManyFeatures(repeats);
  Evaluation evaluation(folder, threads);
  const bool released = what != "given";
  const auto features = [&] {
    for (const char* purpose : {"reference", "real", "generated"}) evaluation.Features(purpose, true);
  };
  if (what == "cached") features();
  if (what == "given") evaluation.Features("reference", false);
  benchmarks::Report(("evaluation_" + what).c_str(), released ? 3 * kRepetitions * kMotions : kMotions, "motions",
                     repeats,
                     [&] {
                       if (what == "released") features();
                       if (what == "given") evaluation.Features("generated", false);
                       if (released) evaluation.Score("real", true);
                       evaluation.Score("generated", released);
                     },
                     threads);
  return evaluation.exit_code();
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  std::string pattern = (std::filesystem::temp_directory_path() / "mocurate_evaluation_XXXXXX").string();
  const std::filesystem::path folder = ::mkdtemp(pattern.data());
  const int exit_code = mocurate::Run(argc > 1 ? argv[1] : "given", argc > 2 ? std::atoi(argv[2]) : 1,
                                      argc > 3 ? std::atoi(argv[3]) : 1, folder);
  std::filesystem::remove_all(folder);
  return exit_code;
}
