#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "core/pipeline/stage.h"

namespace mocurate {

struct Motion;
struct MotionRequest;

/// Generates motions for requests, in their order; the table is independent of the program that does it.
using AnswerRequests = std::function<Expected<std::vector<Motion>>(const std::vector<MotionRequest>& requests)>;

/// Checkpoints used together (MultiAct): `first` generates first actions, `fill` transitions; or empty.
struct GeneratorFiles {
  std::filesystem::path main, first, fill;
  bool align = false;  ///< rotate and move joined motions
};

/// Opens generators. `eval` does not depend on the networks: the worker program passes the loader.
using OpenGenerator = std::function<Expected<AnswerRequests>(const GeneratorFiles& files, int threads)>;

/// Stage `features`: role "weights" (published weights, or a checkpoint of a recogniser) and "motions" (a dataset or
/// MotionSet); with a role "generator", and "first" and "fill" as in GeneratorFiles, its answers to requests drawn from
/// that dataset are scored instead. -> feature file (core/store/feature_file.h). Summary: what a protocol warns of.
StageFunction MakeFeaturesStage(OpenGenerator open_generator);

/// Stage `score`: role "row", optionally "reference_train" and "reference_test" (feature files) -> JSON of ScoreRow,
/// also as the summary.
Expected<StageOutcome> ScoreStage(const StageRequest& request);

/// Stage `compare`: roles "a", "b" and "reference_train" -> JSON of CompareRows, also as the summary.
Expected<StageOutcome> CompareStage(const StageRequest& request);

/// Inputs: role "fit" (Datasets; clips that were moved, cut or resampled are compared in the world and at the times of
/// their recording), "evidence" (of these clips, may be absent), "truth" (ground truth, or a Dataset) -> JSON artifact:
/// errors of joints before and after fitting and of rotations, per clip and overall; "sigma": measures of the stated
/// uncertainty (docs/uncertainty.md); "without_truth": ids. The summary lacks what is per clip. Error kInconsistent: no
/// clip could be compared.
Expected<StageOutcome> FitErrorStage(const StageRequest& request);

/// What the runner must know of each stage; versions are in options.cpp.
StageDeclaration FeaturesDeclaration();
StageDeclaration ScoreDeclaration();
StageDeclaration CompareDeclaration();
StageDeclaration FitErrorDeclaration();

}  // namespace mocurate
