#pragma once

#include "core/pipeline/stage.h"

namespace mocurate {

/// One source file (or one depth sequence) -> evidence artifact (ReadEvidence). Summary: person, label, frames, joints,
/// rate_hz, missing_share.
Expected<StageOutcome> IngestStage(const StageRequest& request);

/// The truth that a source carries beside its evidence -> truth artifact (ReadTruth). Only `evaluate` reads it.
Expected<StageOutcome> TruthStage(const StageRequest& request);

/// The studio: one synthetic capture (a whole set) as the files a real tracker gives, packed in one folder that the run
/// unpacks; see ingest/synthetic/README.md.
Expected<StageOutcome> CaptureStage(const StageRequest& request);

}  // namespace mocurate
