#pragma once

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/sha256.h"
#include "core/base/version.h"
#include "tests/fitting/fit_score.h"

namespace mocurate::benchmarks {

/// What a clip's line has beside its figures: `findings` (code -> number) and `digest`, of the motion with states and
/// stated uncertainty: equal where a fit is bit for bit the same.
inline nlohmann::json OutcomeOf(const FitResult& fit) {
  nlohmann::json findings = nlohmann::json::object();
  for (const Finding& finding : fit.findings) findings[finding.code] = findings.value(finding.code, 0) + 1;
  std::string bytes;
  const auto append = [&](const auto& values) {
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  const Motion& motion = fit.motion;
  append(motion.joints.xyz), append(motion.position_cov), append(motion.state);
  append(motion.rotation_sigma), append(motion.rotation_observed);
  for (const Quaterniond& rotation : motion.rotation) append(rotation.coeffs());
  return {{"findings", findings}, {"digest", Sha256Hex(bytes).substr(0, 16)}};
}

/// Of the audit of a rig.
inline nlohmann::json OutcomeOf(const std::vector<RigFault>& faults) {
  nlohmann::json findings = nlohmann::json::object();
  for (const RigFault& fault : faults) findings[fault.code] = findings.value(fault.code, 0) + 1;
  return {{"findings", findings}};
}

/// One JSON line a clip and fit, appended to the file that MOCURATE_CLIPS names (unset: nothing is written), so that
/// compare_fits.py compares two versions clip by clip: command, version, machine, clip, person, fit and figures, and
/// what is switched off (OptionsWithout).
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
    if (const char* without = std::getenv("MOCURATE_WITHOUT")) common_["without"] = without;
  }

  void Add(const std::string& clip, const std::string& person, const char* fit, const nlohmann::json& figures,
           const nlohmann::json& outcome = nlohmann::json::object()) {
    if (!out_.is_open()) return;
    nlohmann::json line = common_;
    line.update({{"clip", clip}, {"person", person}, {"fit", fit}, {"figures", figures}});
    line.update(outcome);
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
      AddRotationCoverage(result.motion, clip.truth, figures);
    }
    Add(clip.name, std::to_string(clip.subject), fit, figures, OutcomeOf(result));
  }

 private:
  /// Shares of axes whose error lies within one and two stated standard deviations: of rotations that are observed, and
  /// of all.
  static void AddRotationCoverage(const Motion& motion, const Motion& truth, nlohmann::json& figures) {
    std::array<double, 2> one{}, two{}, all{};
    for (int f = 0; f < motion.frame_count(); ++f) {
      for (int j = 1; j < motion.joint_count(); ++j) {
        const Vector3d error = LogQuaternion(truth.rotation_at(f, j).conjugate() * motion.rotation_at(f, j));
        const std::size_t at = 3 * (static_cast<std::size_t>(f) * motion.joint_count() + static_cast<std::size_t>(j));
        for (int i = 0; i < 3; ++i) {
          const double sigmas = std::abs(error[i]) / motion.rotation_sigma[at + i];
          for (const std::size_t kind : {0U, 1U}) {
            if (kind == 0 && !(motion.rotation_observed[at + i] > 0.1F)) continue;
            one[kind] += sigmas < 1.0 ? 1.0 : 0.0;
            two[kind] += sigmas < 2.0 ? 1.0 : 0.0;
            all[kind] += 1.0;
          }
        }
      }
    }
    const std::array<std::string, 2> names{"rotation_", "all_rotation_"};
    for (const std::size_t kind : {0U, 1U}) {
      if (all[kind] == 0.0) continue;
      figures[names[kind] + "within_one"] = one[kind] / all[kind];
      figures[names[kind] + "within_two"] = two[kind] / all[kind];
    }
  }

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
