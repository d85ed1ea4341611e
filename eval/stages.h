#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "core/motion/motion.h"
#include "core/motion/request.h"
#include "core/pipeline/stage.h"

namespace mocurate {

/// Answers requests with motions, in their order. Any program may; the table does not know which one did.
using AnswerRequests = std::function<Expected<std::vector<Motion>>(const std::vector<MotionRequest>& requests)>;

/// Opens the generator of a checkpoint file. `eval` does not know the networks: the worker program passes the loader.
using OpenGenerator = std::function<Expected<AnswerRequests>(const std::filesystem::path& checkpoint)>;

/// Inputs: role "dataset", "recogniser" (one per seed; the first gives the features), "generator", optionally
/// "baseline_dataset" and "baseline_recogniser", "crop_recogniser" -> JSON artifact: the four metrics with repetitions
/// and intervals for the rows Real and one per generator (input name), recogniser accuracy per seed, confusion matrix.
StageFunction MakeEvaluateStage(OpenGenerator open_generator);

/// Inputs: role "fit" (one-clip Datasets), "evidence" (the same clips), "truth" -> JSON artifact: joint error before
/// and after (mm), rotation error (degrees), per clip and overall. Needs no libtorch.
Expected<StageOutcome> FitErrorStage(const StageRequest& request);

}  // namespace mocurate
