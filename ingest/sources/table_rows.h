#pragma once

#include <string>
#include <string_view>

#include "core/formats/joint_layout.h"
#include "ingest/options.h"

namespace mocurate {

/// "decimal_comma": a table with decimal commas, which are read as points.
Finding DecimalCommas();

/// Joints of a table by its declaration. Errors of ParseJointRows; kInconsistent where the rows are not a whole number
/// of frames and the last frames are not a body in the declared order: a row is lost or repeated.
Expected<JointRows> ReadTableRows(const SourceOptions& source, std::string_view bytes, const std::string& name);

}  // namespace mocurate
