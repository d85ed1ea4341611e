#pragma once

#include <string>
#include <string_view>

#include "core/formats/joint_layout.h"
#include "ingest/options.h"

namespace mocurate {

/// "decimal_comma": a table whose numbers are written with commas is read as if these were points.
Finding DecimalCommas();

/// Joints of a table by its declaration. Where the table ends within a frame and no row breaks off its joint, bones
/// tell whether the last frame or the first is not whole. Errors of ParseJointRows; kInconsistent where the count of
/// rows is wrong and nothing tells why.
Expected<JointRows> ReadTableRows(const SourceOptions& source, std::string_view bytes, const std::string& name);

}  // namespace mocurate
