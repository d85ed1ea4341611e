#pragma once

#include <string>

#include "core/base/error.h"

namespace mocurate {

/// Stages in order; a run may stop after any of them.
enum class JobStage { kIngest, kProportions, kFitting, kCanon, kAssemble, kAudit, kTrain, kTable, kReport };

/// "ingest", ..., "report".
const char* Name(JobStage stage);

/// Error kUsage lists the stages.
Expected<JobStage> JobStageFromName(const std::string& name);

}  // namespace mocurate
