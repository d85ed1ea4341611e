#pragma once

#include <string>
#include <string_view>

#include "core/formats/joint_layout.h"
#include "ingest/options.h"

namespace mocurate {

/// Joints of a table by its declaration. Errors of ParseJointRows and CheckHeader; kInconsistent where the rows are not
/// a whole number of frames and the last frames are not a body in the declared order: a row is lost or repeated.
Expected<JointRows> ReadTableRows(const SourceOptions& source, std::string_view bytes, const std::string& name);

}  // namespace mocurate
