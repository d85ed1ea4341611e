#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "core/base/error.h"

namespace mocurate {

/// The first word of the command line that should be a verb ("runn") or a verb of a verb ("config shwo") and is none:
/// error kUsage with the nearest one. Nothing where all verbs exist.
std::optional<Error> UnknownVerb(const CLI::App& app, int argc, char** argv);

/// What is wrong with a command line that could not be parsed: the word, the rule, and the verb or option that was
/// probably meant. Error kUsage.
Error UsageError(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv);

}  // namespace mocurate
