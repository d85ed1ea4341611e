#pragma once

namespace mocurate {

/// Makes this process and its workers use the kernels that the CPU can run; call it before any of them loads BLAS.
/// OpenBLAS detects the CPU's model and falls back to kernels of 2004 ("Prescott", SSE3) for a newer CPU than it knows:
/// Debian 12's 0.3.21 does so on Intel's Emerald Rapids, 32 instead of 150 GF/s of one sgemm thread. Then it sets
/// OPENBLAS_CORETYPE; a set variable and a recognised CPU are left alone.
void ChooseBlasKernels();

}  // namespace mocurate
