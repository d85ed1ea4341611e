#pragma once

#include <CLI/CLI.hpp>

#include "core/base/error.h"

namespace mocurate {

/// What is wrong with a command line that could not be parsed: the word, the rule, and the verb or option that was
/// probably meant. Error kUsage.
Error UsageError(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv);

}  // namespace mocurate
