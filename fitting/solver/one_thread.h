#pragma once

#include <omp.h>

// Of OpenBLAS; absent where another library serves BLAS.
extern "C" void openblas_set_num_threads(int threads) __attribute__((weak));
extern "C" int openblas_get_num_threads() __attribute__((weak));

namespace mocurate {

/// While it lives, OpenMP regions of the calling thread, and BLAS, run on one thread. Debian's CHOLMOD asks for four
/// inside every factorisation whatever OMP_NUM_THREADS says, and OpenBLAS's threads spin while they wait for blocks of
/// sixty rows (measured: each half of the time of a fit); parallelism is over clips.
class OneThread {
 public:
  OneThread() : levels_(omp_get_max_active_levels()) {
    omp_set_max_active_levels(0);
    if (openblas_set_num_threads == nullptr || openblas_get_num_threads == nullptr) return;
    blas_threads_ = openblas_get_num_threads();
    if (blas_threads_ > 1) openblas_set_num_threads(1);
  }
  ~OneThread() {
    omp_set_max_active_levels(levels_);
    if (blas_threads_ > 1) openblas_set_num_threads(blas_threads_);
  }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int levels_;
  int blas_threads_ = 1;
};

}  // namespace mocurate
