#pragma once

#include "core/pipeline/stage.h"

namespace mocurate {

/// Motions of one sensor (inputs role "motion", as in CanonStage) -> JSON: the floor under them (FloorPlane), or null
/// where it is unknown, with a finding "floor_unknown". Finding "sensor_tilt", value: degrees.
Expected<StageOutcome> LevelStage(const StageRequest& request);

/// One clip -> Dataset file with zero or more canonical clips. Input role "motion" (a one-clip Dataset from fitting, or
/// an evidence file whose clip has a given motion) or role "tracks" (an evidence file; its tracks become a joints-only
/// motion on options.skeleton: the baseline without fitting). A clip of which canon.trim keeps nothing is kExcluded,
/// with the rule as its last finding.
Expected<StageOutcome> CanonStage(const StageRequest& request);

/// All canonical clips (inputs role "clip") -> the Dataset file of the run with labels, splits and leak check.
Expected<StageOutcome> AssembleStage(const StageRequest& request);

/// The Dataset (role "dataset") -> JSON artifact: counts per label, person and split, nearest-neighbour accuracy,
/// duplicates, quality measures.
Expected<StageOutcome> AuditStage(const StageRequest& request);

/// What the runner must know of each stage; versions are in options.cpp.
StageDeclaration LevelDeclaration();
StageDeclaration CanonDeclaration();
StageDeclaration AssembleDeclaration();
StageDeclaration AuditDeclaration();

}  // namespace mocurate
