#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

// The only way to stdout and stderr: names and messages of files may hold sequences that a terminal obeys.

namespace mocurate {

/// `text` with \xNN for each byte of a control character, a mark of direction, and what is not UTF-8. Line ends and
/// tabs stay.
std::string TerminalText(std::string_view text);
/// The same without line ends and tabs.
std::string TerminalLine(std::string_view text);

/// printf to stdout, as TerminalText.
[[gnu::format(printf, 1, 2)]] void Print(const char* format, ...);
/// A text and a line end to stdout, as TerminalText.
void PrintLine(std::string_view text);
/// A document and a line end to stdout, all of it ASCII; indent -1: on one line.
void PrintJson(const nlohmann::json& document, int indent = 1);
/// A text to stderr, as TerminalText.
void PrintError(std::string_view text);

}  // namespace mocurate
