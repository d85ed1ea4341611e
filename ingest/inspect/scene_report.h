#pragma once

#include <string>
#include <vector>

#include "ingest/inspect/inspection.h"
#include "ingest/inspect/read_raw.h"

namespace mocurate {

/// Appends one entry per camera, with what the calibration's R, t and unit mean, and its contradictions as findings.
void ReportCameras(const Calibration& calibration, const std::string& file, Inspection& inspection);

/// Appends points, triangles, extent, and the unit if the shape is as high as a person.
void ReportCloud(const RawCloud& cloud, const std::string& file, Inspection& inspection);

/// What annotations say of motions beside the motions of the same inspection: "annotation_duration", as a run tells
/// it, where a clip lasts otherwise; "motion_missing" (warning) of a sequence whose `feat_p` names no file of a folder
/// that is here, at most 20, and (info) how many lie in folders that are not. Nothing without clips of AMASS.
void CompareAnnotations(const std::vector<AnnotatedMotion>& annotated, Inspection& inspection);

}  // namespace mocurate
