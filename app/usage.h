#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "core/base/error.h"

namespace mocurate {

/// Error kUsage, with the nearest verb, for a word of the command line that should be a verb ("runn") or subverb
/// ("config shwo") and does not exist. Empty where all verbs exist.
std::optional<Error> UnknownVerb(const CLI::App& app, int argc, char** argv);

/// Error kUsage of a command line that could not be parsed: the word, the rule, and the verb or option that was
/// probably meant.
Error UsageError(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv);

}  // namespace mocurate
