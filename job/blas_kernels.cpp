#include "job/blas_kernels.h"

#include <dlfcn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace mocurate {
namespace {

constexpr const char* kVariable = "OPENBLAS_CORETYPE";

/// The kernels, by OpenBLAS's name, that the CPU can run; null where its oldest ones are right.
const char* KernelsOfInstructionSets() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("fma")) {
    return "SkylakeX";
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return "Haswell";
#endif
  return nullptr;
}

/// Whether OpenBLAS chooses its oldest kernels here. Asked in a child process: it chooses once, while it loads.
bool OpenBlasChoosesItsOldest() {
  const pid_t child = fork();
  if (child == 0) {
    setenv("OPENBLAS_NUM_THREADS", "1", 1);
    void* library = dlopen("libblas.so.3", RTLD_LAZY | RTLD_LOCAL);
    const auto name =
        library != nullptr ? reinterpret_cast<const char* (*)()>(dlsym(library, "openblas_get_corename")) : nullptr;
    _exit(name != nullptr && std::strcmp(name(), "Prescott") == 0 ? 1 : 0);
  }
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 1;
}

}  // namespace

void ChooseBlasKernels() {
  const char* kernels = KernelsOfInstructionSets();
  if (kernels == nullptr || std::getenv(kVariable) != nullptr || !OpenBlasChoosesItsOldest()) return;
  setenv(kVariable, kernels, 0);
}

}  // namespace mocurate
