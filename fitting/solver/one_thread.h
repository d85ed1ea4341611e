#pragma once

#include <omp.h>

namespace mocurate {

/// While it lives, OpenMP regions of the calling thread run on one thread. Debian's CHOLMOD asks for four inside every
/// factorisation whatever OMP_NUM_THREADS says, and on small supernodes they only wait for each other (measured: half
/// of the time of a fit); parallelism is over clips.
class OneThread {
 public:
  OneThread() : levels_(omp_get_max_active_levels()) { omp_set_max_active_levels(0); }
  ~OneThread() { omp_set_max_active_levels(levels_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int levels_;
};

}  // namespace mocurate
