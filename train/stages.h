#pragma once

#include "core/pipeline/stage.h"

namespace mocurate {

/// Input role "dataset"; options (NetworkOptions) say which network. -> checkpoint (HDF5) of the trained network with
/// its history (loss per step, validation accuracy per check). Partial state goes to request.scratch and training goes
/// on from there bit for bit.
Expected<StageOutcome> TrainStage(const StageRequest& request);

}  // namespace mocurate
