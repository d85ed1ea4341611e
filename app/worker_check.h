#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mocurate {

/// A shared library that a program needs and this machine has not.
struct MissingLibrary {
  std::string name;     ///< "libtorch_cpu.so.1.13"
  std::string package;  ///< Debian 12 package that holds it; empty when unknown
};

/// Whether a worker program starts, and if not, why.
struct WorkerCheck {
  bool starts = false;
  std::string version;                  ///< its answer to --version
  std::vector<MissingLibrary> missing;  ///< as its dynamic linker tells
  std::string last_words;               ///< last line it printed when it did not start
};

/// Asks the dynamic linker which libraries `program` lacks, then starts it with --version. No shell is involved.
WorkerCheck CheckWorkerProgram(const std::filesystem::path& program);

/// Debian 12 package of a shared library that mocurate links; empty when it is not one of them.
std::string PackageOfLibrary(const std::string& library);

}  // namespace mocurate
