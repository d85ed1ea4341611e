#pragma once

#include <vector>

#include "ingest/inspect/read_raw.h"

namespace mocurate {

/// What annotations say of motions beside the motions of the same inspection: "annotation_duration", as a run tells
/// it, where a clip lasts otherwise; "motion_missing" (warning) of a sequence whose `feat_p` names no file of a folder
/// that is here, at most 20, and (info) how many lie in folders that are not. Nothing without clips of AMASS.
void CompareAnnotations(const std::vector<AnnotatedMotion>& annotated, Inspection& inspection);

}  // namespace mocurate
