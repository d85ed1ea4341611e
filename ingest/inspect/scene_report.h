#pragma once

#include <string>

#include "ingest/inspect/inspection.h"
#include "ingest/inspect/read_raw.h"

namespace mocurate {

/// Appends one entry per camera, with what the calibration's R, t and unit mean, and its contradictions as findings.
void ReportCameras(const Calibration& calibration, const std::string& file, Inspection& inspection);

/// Appends points, triangles, extent, and the unit if the shape is as high as a person.
void ReportCloud(const RawCloud& cloud, const std::string& file, Inspection& inspection);

}  // namespace mocurate
