#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mocurate {

/// A shared library that a program needs and this machine lacks.
struct MissingLibrary {
  std::string name;     ///< "libtorch_cpu.so.1.13"
  std::string package;  ///< Debian 12 package that contains it; empty when unknown
};

/// Whether a worker program starts, and the reason if not.
struct WorkerCheck {
  bool starts = false;
  std::string version;                  ///< its answer to --version
  std::vector<MissingLibrary> missing;  ///< reported by its dynamic linker
  std::string last_output_line;         ///< last line it printed when it did not start
};

/// Asks the dynamic linker for missing libraries of `program`, then starts it with --version. No shell is involved.
WorkerCheck CheckWorkerProgram(const std::filesystem::path& program);

/// Debian 12 package of a shared library that mocurate links; empty for other libraries.
std::string PackageOfLibrary(const std::string& library);

}  // namespace mocurate
