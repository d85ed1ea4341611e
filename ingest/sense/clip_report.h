#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "ingest/sense/measure.h"

namespace mocurate {

/// One clip as it stands in the answer of InspectPath. With a source, its statements are the values and the measured
/// ones stand beside them; contradictions and remarks are appended to `findings`. `declared_name`: the file below the
/// source's folder, for what its name says; empty where names say nothing of files (a container's clips, those of many
/// files).
nlohmann::json ClipReport(const ObservedClip& clip, const std::string& file, const std::optional<SourceOptions>& source,
                          const std::string& declared_name, nlohmann::json& findings);

/// What a run says of a file whose name the source does not read: nothing where other files are to be ignored.
void TellUnread(const SourceOptions& source, const std::string& file, const Error& why, nlohmann::json& findings);

/// {"value", "from", "confidence", "evidence"}; "unknown" where the value is null or an empty text.
nlohmann::json ReportValue(nlohmann::json value, const char* from, double confidence, const std::string& evidence);
nlohmann::json ReportValue(const Measured& measured);

/// {"code", "severity", "where", "value", "message"}
nlohmann::json InspectionFinding(const std::string& code, Severity severity, const std::string& where, double value,
                                 const std::string& message);

}  // namespace mocurate
