#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "job/verbs/verbs.h"

namespace mocurate {

/// The command line of the program, to which verbs are added.
struct CommandLine {
  CLI::App& app;
  CommonArguments& common;
  std::function<Status()>& verb;  ///< what the parsed words ask for

  /// `call` with the arguments becomes the verb when `command` is parsed.
  template <class Call, class Arguments>
  void Calls(CLI::App* command, Call call, std::shared_ptr<Arguments> arguments) const {
    command->callback([&common = common, &verb = verb, call, arguments] {
      verb = [&common, call, arguments] { return call(common, *arguments); };
    });
  }
};

/// An option that may be repeated, with one value each time.
template <class Value>
CLI::Option* AddRepeated(CLI::App* command, const char* name, std::vector<Value>& values, const std::string& help) {
  return command->add_option(name, values, help)->allow_extra_args(false);
}

/// --set KEY=VALUE, which may be repeated.
inline CLI::Option* AddAssignments(CLI::App* command, std::vector<std::string>& assignments, const std::string& help) {
  return AddRepeated(command, "--set", assignments, help)->type_name("KEY=VALUE");
}

inline void AddJobCount(CLI::App* command, int& jobs, const char* help = "worker processes (default: one per core)") {
  command->add_option("-j,--jobs", jobs, help)->check(CLI::Range(0, 1024));
}

/// Each function adds subcommands with their options and help.
void AddRunVerbs(const CommandLine& line);
void AddMotionVerbs(const CommandLine& line);
void AddDatasetVerbs(const CommandLine& line);
void AddSourceVerbs(const CommandLine& line);

}  // namespace mocurate
