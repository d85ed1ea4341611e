#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "ingest/sense/measure.h"

namespace mocurate {

/// One clip as it stands in the answer of InspectPath, without a source; what is wrong with it is appended to
/// `findings`.
nlohmann::json ClipReport(const ObservedClip& clip, const std::string& file, nlohmann::json& findings);

/// The same of a clip that a run of `source` gives (ObserveClip): its statements are the values, and the measured ones
/// stand beside them. What is wrong with it are the run's findings;
/// "many_missing" is appended.
nlohmann::json DeclaredReport(const ObservedClip& clip, const std::string& file, const SourceOptions& source,
                              nlohmann::json& findings);

/// {"value", "from", "confidence", "evidence"}; "unknown" where the value is null or an empty text.
nlohmann::json ReportValue(nlohmann::json value, const char* from, double confidence, const std::string& evidence);
nlohmann::json ReportValue(const Measured& measured);

/// {"code", "severity", "where", "value", "message"}
nlohmann::json InspectionFinding(const std::string& code, Severity severity, const std::string& where, double value,
                                 const std::string& message);

}  // namespace mocurate
