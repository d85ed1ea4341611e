#pragma once

#include <string>
#include <string_view>

#include "core/base/error.h"

namespace mocurate {

/// The code of what is wrong with a file that gives no clip, the same in an inspection and as the rule of a run's log.
/// `format` as a source names it ("joint_table"); empty or another: nothing more is known than the error says.
std::string FaultCode(const Error& error, std::string_view format);

}  // namespace mocurate
