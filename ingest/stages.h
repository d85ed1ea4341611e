#pragma once

#include "core/pipeline/stage.h"

namespace mocurate {

/// One source file (or one depth sequence) -> evidence artifact (ReadEvidence). Summary: person, label, frames, joints,
/// rate_hz, missing_share.
Expected<StageOutcome> IngestStage(const StageRequest& request);

/// All evidence of a source (inputs of role "evidence", named by their items) -> a JSON list of findings: clips that
/// show what another, earlier by name, shows (core/quality/duplicates.h). Options: CheckOptions. Summary: "items", the
/// item of each finding; "dropped", items that are to be excluded with the threshold of the rule.
Expected<StageOutcome> DuplicatesStage(const StageRequest& request);

/// The truth that a source carries beside its evidence -> truth artifact (ReadTruth). Only `evaluate` reads it.
Expected<StageOutcome> TruthStage(const StageRequest& request);

/// The studio: one synthetic capture (a whole set) as the files a real tracker gives, packed in one folder that the run
/// unpacks; see docs/studio.md.
Expected<StageOutcome> CaptureStage(const StageRequest& request);

/// What the runner must know of each stage; versions are in options.cpp.
StageDeclaration IngestDeclaration();
StageDeclaration MotionsDeclaration();
StageDeclaration DuplicatesDeclaration();
StageDeclaration TruthDeclaration();
StageDeclaration CaptureDeclaration();

}  // namespace mocurate
