#include "job/blas_kernels.h"

#include <dlfcn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
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

constexpr std::array<const char*, 3> kInstructionLevels = {"baseline", "avx2", "avx512"};

std::size_t RankOf(const std::string& instructions) {
  return static_cast<std::size_t>(std::find(kInstructionLevels.begin(), kInstructionLevels.end(), instructions) -
                                  kInstructionLevels.begin());
}

}  // namespace

std::string BlasKernels() {
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    void* library = dlopen("libblas.so.3", RTLD_LAZY | RTLD_LOCAL);
    const auto name =
        library != nullptr ? reinterpret_cast<const char* (*)()>(dlsym(library, "openblas_get_corename")) : nullptr;
    const char* text = name != nullptr ? name() : "";
    const ssize_t written = write(ends[1], text, std::strlen(text));
    _exit(written >= 0 ? 0 : 1);
  }
  close(ends[1]);
  char text[64] = {};
  const ssize_t count = child > 0 ? read(ends[0], text, sizeof(text) - 1) : 0;
  close(ends[0]);
  if (child > 0) waitpid(child, nullptr, 0);
  return std::string(text, static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
}

std::string Instructions() {
  const char* kernels = KernelsOfInstructionSets();
  if (kernels == nullptr) return kInstructionLevels[0];
  return std::strcmp(kernels, "SkylakeX") == 0 ? kInstructionLevels[2] : kInstructionLevels[1];
}

Status PinKernels(const std::string& blas_kernels, const std::string& instructions) {
  if (RankOf(Instructions()) < RankOf(instructions)) {
    return Fail(ErrorCode::kMissingOnHost,
                "the plan was made for " + instructions + ", this CPU has " + Instructions() +
                    ": results would have other bytes",
                "plan", "choose nodes with " + instructions + ", or plan on one of these nodes");
  }
  if (!blas_kernels.empty()) setenv(kVariable, blas_kernels.c_str(), 1);
  if (const std::string here = BlasKernels(); here != blas_kernels) {
    return Fail(ErrorCode::kMissingOnHost,
                "the plan was made with OpenBLAS's kernels '" + blas_kernels + "', here they are '" + here +
                    "': results would have other bytes",
                "plan", "choose nodes with the same OpenBLAS (libopenblas0-pthread), or plan on one of these nodes");
  }
  setenv("ATEN_CPU_CAPABILITY", instructions == kInstructionLevels[0] ? "default" : instructions.c_str(), 1);
  return {};
}

void ChooseBlasKernels() {
  const char* kernels = KernelsOfInstructionSets();
  if (kernels == nullptr || std::getenv(kVariable) != nullptr || !OpenBlasChoosesItsOldest()) return;
  setenv(kVariable, kernels, 0);
}

}  // namespace mocurate
