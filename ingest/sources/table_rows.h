#pragma once

#include <string>
#include <string_view>

#include "core/formats/joint_layout.h"
#include "ingest/options.h"

namespace mocurate {

/// "decimal_comma": a table whose numbers are written with commas is read as if these were points.
Finding DecimalCommas();

/// Joints of a table by its declaration. Errors of ParseJointRows; kInconsistent where the rows are no whole number of
/// frames and the last frames are no body in the declared order: the file is not cut off, but a row is lost or too
/// many.
Expected<JointRows> ReadTableRows(const SourceOptions& source, std::string_view bytes, const std::string& name);

}  // namespace mocurate
