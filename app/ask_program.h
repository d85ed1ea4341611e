#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mocurate {

/// What a program said and how it ended.
struct ProgramAnswer {
  int exit_status = -1;    ///< -1: a signal ended it, or it could not be started
  std::string text;        ///< stdout, and stderr where it was asked for
  bool timed_out = false;  ///< it was ended for its silence
};

/// What is heard of a program, and for how long.
struct Listening {
  bool errors = true;      ///< stderr too, in the order of writing; else it goes to /dev/null
  double silence_s = 0.0;  ///< a program that says nothing for so long is ended; 0: no limit
};

/// Starts `program` with our environment, of which `setting` ("LC_ALL=C") replaces one variable, no input and no shell,
/// and reads all it says.
ProgramAnswer AskProgram(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                         const std::string& setting, const Listening& listening = {});

}  // namespace mocurate
