#pragma once

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/version.h"
#include "tests/fitting/fit_score.h"

namespace mocurate::benchmarks {

/// One JSON line a clip and fit, appended to the file that MOCURATE_CLIPS names (unset: nothing is written), so that
/// compare_fits.py compares two versions clip by clip: command, version, machine, clip, person, fit and figures.
class ClipLines {
 public:
  ClipLines(int argc, char** argv) {
    const char* file = std::getenv("MOCURATE_CLIPS");
    if (file == nullptr) return;
    out_.open(file, std::ios::app);
    if (!out_) std::fprintf(stderr, "%s: cannot be written\n", file), std::exit(2);
    std::string command = argv[0];
    command = command.substr(command.rfind('/') + 1);
    for (int i = 1; i < argc; ++i) command += std::string(" ") + argv[i];
    common_ = {{"command", command}, {"version", Version()}, {"machine", Processor()}};
  }

  void Add(const std::string& clip, const std::string& person, const char* fit, const nlohmann::json& figures) {
    if (!out_.is_open()) return;
    nlohmann::json line = common_;
    line.update({{"clip", clip}, {"person", person}, {"fit", fit}, {"figures", figures}});
    out_ << line.dump() << std::endl;
  }

  void Add(const StudioClip& clip, const char* fit, const FitResult& result, double cpu_seconds) {
    if (!out_.is_open()) return;
    FitScore score;
    score.Add(result, clip);
    nlohmann::json figures = {{"joint_mm", score.joint_mm()},
                              {"rotation_deg", score.rotation_deg()},
                              {"frames_per_s", score.frames / cpu_seconds}};
    if (score.whitened > 0) {
      figures["within_one"] = score.within_one();
      figures["within_two"] = score.within_two();
    }
    Add(clip.name, std::to_string(clip.subject), fit, figures);
  }

 private:
  static std::string Processor() {
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
      if (line.rfind("model name", 0) == 0) {
        return line.substr(line.find(':') + 2) + ", " + std::to_string(sysconf(_SC_NPROCESSORS_ONLN)) + " cores";
      }
    }
    return "unknown";
  }

  std::ofstream out_;
  nlohmann::json common_;
};

}  // namespace mocurate::benchmarks
