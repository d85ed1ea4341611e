#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// Makes this process and its workers use the kernels that the CPU can run; call it before any of them loads BLAS.
/// OpenBLAS detects the CPU's model and falls back to kernels of 2004 ("Prescott", SSE3) for a newer CPU than it knows:
/// Debian 12's 0.3.21 does so on Intel's Emerald Rapids, 32 instead of 150 GF/s of one sgemm thread. Then it sets
/// OPENBLAS_CORETYPE; a set variable and a recognised CPU are left alone.
void ChooseBlasKernels();

/// OpenBLAS's name for the kernels that it takes here; empty where it does not tell.
std::string BlasKernels();

/// The instruction set extensions that libraries choose their code by: "avx512", "avx2" or "baseline".
std::string Instructions();

/// Makes this process and its workers compute as on the machine of a plan: the same kernels of OpenBLAS and of torch.
/// Error kMissingOnHost where this CPU cannot.
Status PinKernels(const std::string& blas_kernels, const std::string& instructions);

/// Facts that the bytes of a result may depend on besides input and options, and its time: system, CPU model,
/// instruction sets, the BLAS that workers load and its kernels, and variables that override either.
nlohmann::json MachineFacts();

}  // namespace mocurate
