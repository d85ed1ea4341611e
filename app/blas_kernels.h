#pragma once

namespace mocurate {

/// Lets this process and its workers, before any of them loads BLAS, use the kernels that the CPU can run. OpenBLAS
/// asks for the CPU's model and falls back to kernels of 2004 ("Prescott", SSE3) where the CPU is newer than it: Debian
/// 12's 0.3.21 does on Intel's Emerald Rapids, 32 instead of 150 GF/s of one sgemm thread. Sets OPENBLAS_CORETYPE then;
/// leaves it alone where it is set or OpenBLAS knows better.
void ChooseBlasKernels();

}  // namespace mocurate
