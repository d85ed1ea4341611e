#pragma once

#include "core/pipeline/stage.h"

namespace mocurate {

/// Input role "dataset"; options pick the network. -> checkpoint (HDF5) of the trained network with its history (loss
/// per step, validation accuracy per check). Item "recogniser/SEED" or "action2motion". Partial state goes to
/// request.scratch and training goes on from there bit for bit.
Expected<StageOutcome> TrainRecogniserStage(const StageRequest& request);
Expected<StageOutcome> TrainGeneratorStage(const StageRequest& request);

}  // namespace mocurate
