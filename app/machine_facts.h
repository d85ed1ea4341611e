#pragma once

#include <nlohmann/json_fwd.hpp>

namespace mocurate {

/// What the bytes of a result may depend on besides input and options, and what its time depends on: system, CPU model,
/// instruction sets, the BLAS that workers load and the kernels it chose, and variables that override either.
nlohmann::json MachineFacts();

}  // namespace mocurate
