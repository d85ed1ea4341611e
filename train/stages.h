#pragma once

#include "core/pipeline/stage.h"

namespace mocurate {

/// Input role "dataset", and "made" for clips that are mixed with its (AddMade); options (NetworkOptions) say which
/// network. -> checkpoint (HDF5) of the trained network with
/// its history (loss per step, validation accuracy per check). Partial state goes to request.scratch and training goes
/// on from there bit for bit.
Expected<StageOutcome> TrainStage(const StageRequest& request);

/// Input and options of an item of `train` -> what its training would take here, from a few steps of it: {"steps",
/// "seconds_per_step", "parameters"}. Never cached: it is a figure of the machine.
Expected<StageOutcome> TrainCostStage(const StageRequest& request);

/// Inputs "generator" (checkpoint) and "requests" -> the MotionSet that answers them, with "first" and "fill"
/// (checkpoints) and "previous" (a dataset whose clips requests name) those of scripts as LongMotionOptions say; with
/// "motions" (a dataset) in the place of requests a motion for each of its clips as RemakeOptions say.
Expected<StageOutcome> GenerateStage(const StageRequest& request);

}  // namespace mocurate
