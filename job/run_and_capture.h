#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace mocurate {

/// Output of a program and how it ended.
struct ProgramAnswer {
  int exit_status = -1;    ///< -1: a signal ended it, or it could not be started
  std::string text;        ///< stdout, and stderr if requested
  bool timed_out = false;  ///< it was ended after its silence limit
};

/// What to read of a program, and for how long.
struct CaptureOptions {
  bool errors = true;      ///< stderr too, in the order of writing; else it is discarded
  double silence_s = 0.0;  ///< a program without output for this time is ended; 0: no limit
};

/// Starts `program` with our environment and LC_ALL=C, without input and shell, and reads its output.
ProgramAnswer RunAndCapture(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                            const CaptureOptions& listening = {});

/// The last line of an output that is not blank, trimmed; empty without one.
std::string LastLine(std::string_view text);

}  // namespace mocurate
