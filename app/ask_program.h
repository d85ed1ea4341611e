#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mocurate {

/// What a program said and how it ended.
struct ProgramAnswer {
  int exit_status = -1;  ///< -1: a signal ended it, or it could not be started
  std::string text;      ///< stdout and stderr
};

/// Starts `program` with our environment and `setting` ("LC_ALL=C"), no input and no shell, and reads all it says.
ProgramAnswer AskProgram(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                         const std::string& setting);

}  // namespace mocurate
