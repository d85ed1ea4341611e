#pragma once

#include "core/pipeline/stage.h"

namespace mocurate {

/// Input role "dataset", and "made" for clips that are mixed with its clips (AddMade); options (NetworkOptions) define
/// the network. -> checkpoint (HDF5) of the trained network with its history (loss per step, validation accuracy per
/// check). Partial state is saved in request.scratch, and training resumes from it bit for bit.
Expected<StageOutcome> TrainStage(const StageRequest& request);

/// Input and options of an item of `train` -> estimated cost of its training here, from a few steps: {"steps",
/// "seconds_per_step", "parameters"}. Never cached, because it depends on the machine.
Expected<StageOutcome> TrainCostStage(const StageRequest& request);

/// Inputs "generator" (checkpoint) and "requests" -> the MotionSet generated for them; for scripts also "first" and
/// "fill" (checkpoints) and "previous" (a dataset whose clips requests name) by LongMotionOptions. With "motions" (a
/// dataset) instead of requests: a motion for each of its clips by RemakeOptions.
Expected<StageOutcome> GenerateStage(const StageRequest& request);

/// What the runner must know of each stage; versions are in options.cpp.
StageDeclaration TrainDeclaration();
StageDeclaration TrainCostDeclaration();
StageDeclaration GenerateDeclaration();

}  // namespace mocurate
