#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "fitting/proportions.h"
#include "fitting/solver/joint_track_fit.h"
#include "tests/fitting/track_problems.h"

// Frames per second of one core, with the errors they reach. Needs the reference problems (MOCURATE_REFERENCE, or
// beside MOCURATE_GOLDENS) and the unpacked data (MOCURATE_DATA). Run with OPENBLAS_NUM_THREADS=1.
namespace mocurate {
namespace {

ProportionsOptions MediansOnly() {
  ProportionsOptions options;
  options.symmetric = false;
  return options;
}

/// Unknown bones: medians, then one fit; the time includes both.
void BM_ReferenceProblem(benchmark::State& state, const std::filesystem::path& path, PoseSolver solver,
                         double tolerance) {
  const ReferenceProblem problem = ReadReferenceProblem(path);
  JointTrackOptions options;
  options.solver = solver;
  options.steps = {{FreeParts::kPose, StepEvidence::kAll, tolerance, 200}};  // one solve of one stated problem
  options.uncertainty = false;
  double rms = 0.0;
  FitResult fit;
  for (auto _ : state) {
    const auto person = EstimateProportions({problem.tracks}, problem.tracks.skeleton, MediansOnly());
    auto result = FitJointTracks(problem.tracks, problem.rate, person.bone_length, options);
    if (!result) return state.SkipWithError(result.error().Message().c_str());
    fit = std::move(*result);
    rms = RmsError(fit.motion.joints, problem.truth);
  }
  state.counters["frames/s"] =
      benchmark::Counter(static_cast<double>(problem.tracks.frames()), benchmark::Counter::kIsIterationInvariantRate);
  state.counters["rms_mm"] = 1e3 * rms;
  state.counters["iterations"] = fit.iterations;
  state.counters["cost"] = fit.final_cost;
}

std::vector<SkeletonTracks> KardPerson(const std::filesystem::path& folder, const SkeletonPtr& skeleton) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.find("_s01_e01_realworld.txt") != std::string::npos) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<SkeletonTracks> clips;
  for (const auto& file : files) {
    auto tracks = MapTracks(ReadKardText(file), skeleton);
    if (tracks) clips.push_back(std::move(*tracks));
  }
  return clips;
}

/// One clip of each of KARD's 18 activities, one person; proportions before the clock starts.
void BM_Kard(benchmark::State& state, const std::filesystem::path& folder, PoseSolver solver, double tolerance) {
  const auto skeleton = LoadSkeleton("openni16");
  if (!skeleton) return state.SkipWithError(skeleton.error().Message().c_str());
  const std::vector<SkeletonTracks> clips = KardPerson(folder, *skeleton);
  const auto person = EstimateProportions(clips, *skeleton, ProportionsOptions{});
  JointTrackOptions options;
  options.solver = solver;
  options.steps = {{FreeParts::kPose, StepEvidence::kAll, tolerance, 200}};  // one solve of one stated problem
  options.uncertainty = false;
  double frames = 0.0;
  double square = 0.0;
  double cost = 0.0;
  double iterations = 0.0;
  for (auto _ : state) {
    frames = square = cost = iterations = 0.0;
    for (const SkeletonTracks& clip : clips) {
      const auto fit = FitJointTracks(OnBody(clip, person.skeleton), FrameRate{30, 1}, person.bone_length, options);
      if (!fit) return state.SkipWithError(fit.error().Message().c_str());
      frames += clip.frames();
      square += fit->residual_rms * fit->residual_rms * clip.frames();
      cost += fit->final_cost;
      iterations += fit->iterations;
    }
  }
  state.counters["frames/s"] = benchmark::Counter(frames, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["residual_rms_mm"] = 1e3 * std::sqrt(square / frames);
  state.counters["iterations"] = iterations / static_cast<double>(clips.size());
  state.counters["cost"] = cost;
}

void RegisterAll() {
  const std::filesystem::path problems = ReferenceFolder();
  const char* data = std::getenv("MOCURATE_DATA");
  for (const PoseSolver solver : {PoseSolver::kCeres, PoseSolver::kBanded}) {
    for (const double tolerance : {1e-4, 1e-6}) {
      const std::string method =
          std::string(solver == PoseSolver::kCeres ? "/ceres" : "/banded") + (tolerance == 1e-4 ? "/1e-4" : "/1e-6");
      for (const std::string name : {"platform_seed0", "platform_seed1", "platform_seed2", "platform_dropouts5_seed0",
                                     "platform_dropouts5_seed1"}) {
        if (problems.empty()) break;
        benchmark::RegisterBenchmark((name + method).c_str(), BM_ReferenceProblem, problems / (name + ".h5"), solver,
                                     tolerance)
            ->Unit(benchmark::kMillisecond);
      }
      if (data == nullptr) continue;
      benchmark::RegisterBenchmark(("kard_18_clips" + method).c_str(), BM_Kard,
                                   std::filesystem::path(data) / "kinect" / "kard", solver, tolerance)
          ->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace
}  // namespace mocurate

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  mocurate::RegisterAll();
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
