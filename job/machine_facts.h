#pragma once

#include <nlohmann/json_fwd.hpp>

namespace mocurate {

/// Facts that the bytes of a result may depend on besides input and options, and its time: system, CPU model,
/// instruction sets, the BLAS that workers load and its kernels, and variables that override either.
nlohmann::json MachineFacts();

}  // namespace mocurate
