#pragma once

#include <string>
#include <vector>

#include "ingest/inspect/inspection.h"
#include "ingest/inspect/measure.h"
#include "ingest/options.h"

namespace mocurate {

/// One clip as it stands in an inspection without a source; what is wrong with it is appended to `findings`.
InspectedClip ClipReport(const RawClip& clip, const std::string& file, std::vector<Finding>& findings);

/// The same of a clip that a run of `source` gives (ReadRawClip): its statements are the values, and the measured ones
/// stand beside them. What is wrong with it are the run's findings; "many_missing" is appended.
InspectedClip DeclaredReport(const RawClip& clip, const std::string& file, const SourceOptions& source,
                             std::vector<Finding>& findings);

Reported<std::string> MeasuredText(const Measured& measured);

}  // namespace mocurate
