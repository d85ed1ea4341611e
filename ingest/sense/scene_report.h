#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "ingest/sense/observe.h"

namespace mocurate {

/// Appends one entry per camera, with what the calibration's R, t and unit mean, and its contradictions as findings.
void ReportCameras(const Calibration& calibration, const std::string& file, nlohmann::json& cameras,
                   nlohmann::json& findings);

/// Points, triangles, extent, and the unit if the shape is as high as a person.
nlohmann::json CloudReport(const ObservedCloud& cloud, const std::string& file, nlohmann::json& findings);

nlohmann::json CompanionReport(const ObservedCompanion& companion);

}  // namespace mocurate
