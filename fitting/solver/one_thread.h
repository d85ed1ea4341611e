#pragma once

#include <dlfcn.h>
#include <omp.h>

namespace mocurate {

/// While it exists, OpenMP regions of the calling thread, and OpenBLAS (as the BLAS), run on one thread. Debian's
/// CHOLMOD requests four inside every factorisation whatever OMP_NUM_THREADS is, and OpenBLAS's threads spin while they
/// wait for blocks of sixty rows: half of a fit's time on a quiet machine, most of it on a busy one. Parallelism is
/// over clips.
class OneThread {
 public:
  OneThread() : omp_levels_(omp_get_max_active_levels()), blas_threads_(BlasThreads()) {
    omp_set_max_active_levels(0);
    if (blas_threads_ > 1) SetBlasThreads(1);
  }
  ~OneThread() {
    omp_set_max_active_levels(omp_levels_);
    if (blas_threads_ > 1) SetBlasThreads(blas_threads_);
  }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  static int BlasThreads() {
    static const auto get = reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_num_threads"));
    return get != nullptr ? get() : 1;
  }
  static void SetBlasThreads(int threads) {
    static const auto set = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
    if (set != nullptr) set(threads);
  }

  int omp_levels_;
  int blas_threads_;
};

}  // namespace mocurate
