#include "job/machine_facts.h"

#include <dlfcn.h>
#include <sys/utsname.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

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
