#include "job/machine.h"

#include <dlfcn.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "core/base/file.h"
#include "core/base/text.h"

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

constexpr std::array<const char*, 3> kInstructionLevels = {"baseline", "avx2", "avx512"};

std::size_t RankOf(const std::string& instructions) {
  return static_cast<std::size_t>(std::find(kInstructionLevels.begin(), kInstructionLevels.end(), instructions) -
                                  kInstructionLevels.begin());
}

/// Empty where the system does not report it.
std::string CpuModel() {
  const auto text = ReadFile("/proc/cpuinfo");
  if (!text) return "";
  for (const std::string_view line : SplitText(*text, '\n')) {
    const std::size_t colon = line.find(':');
    if (colon != std::string_view::npos && Trim(line.substr(0, colon)) == "model name") {
      return std::string(Trim(line.substr(colon + 1)));
    }
  }
  return "";
}

/// Instruction sets by which numerical libraries choose their kernels.
nlohmann::json SimdSets() {
  nlohmann::json sets = nlohmann::json::array();
#if defined(__x86_64__)
  if (__builtin_cpu_supports("sse4.2")) sets.push_back("sse4.2");
  if (__builtin_cpu_supports("avx")) sets.push_back("avx");
  if (__builtin_cpu_supports("fma")) sets.push_back("fma");
  if (__builtin_cpu_supports("avx2")) sets.push_back("avx2");
  if (__builtin_cpu_supports("avx512f")) sets.push_back("avx512f");
#elif defined(__aarch64__)
  sets.push_back("neon");
#endif
  return sets;
}

/// The library behind libblas.so.3, as workers find it; null when there is none.
nlohmann::json Blas() {
  setenv("OPENBLAS_NUM_THREADS", "1", 0);  // read while it loads: no pool of threads in this process
  void* library = dlopen("libblas.so.3", RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr) return nullptr;
  nlohmann::json blas = nlohmann::json::object();
  Dl_info info{};
  if (void* sgemm = dlsym(library, "sgemm_"); sgemm != nullptr && dladdr(sgemm, &info) != 0) {
    std::error_code ignored;
    blas["library"] = DisplayPath(std::filesystem::canonical(info.dli_fname, ignored));
  }
  using TextOf = const char* (*)();
  for (const auto& [name, function] :
       {std::pair{"kernels", "openblas_get_corename"}, {"build", "openblas_get_config"}}) {
    if (const auto text = reinterpret_cast<TextOf>(dlsym(library, function)); text != nullptr) blas[name] = text();
  }
  return blas;
}

nlohmann::json Overrides() {
  nlohmann::json set = nlohmann::json::object();
  for (const char* name : {"ATEN_CPU_CAPABILITY", "OPENBLAS_CORETYPE", "MKL_CBWR", "LD_PRELOAD", "LD_LIBRARY_PATH"}) {
    if (const char* value = std::getenv(name); value != nullptr) set[name] = value;
  }
  return set;
}

}  // namespace

std::string BlasKernels() {
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    setenv("OPENBLAS_NUM_THREADS", "1", 1);
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
  if (kernels == nullptr || std::getenv(kVariable) != nullptr || BlasKernels() != "Prescott") return;
  setenv(kVariable, kernels, 0);
}

nlohmann::json MachineFacts() {
  struct utsname host {};
  uname(&host);
  return {{"system", host.sysname},
          {"release", host.release},
          {"architecture", host.machine},
          {"cores", std::thread::hardware_concurrency()},
          {"cpu", CpuModel()},
          {"simd", SimdSets()},
          {"blas", Blas()},
          {"overrides", Overrides()}};
}

}  // namespace mocurate
