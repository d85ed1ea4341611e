#pragma once

#include <string_view>

namespace mocurate {

enum class LogLevel { kError, kWarning, kInfo, kDebug };

/// Lines go to stderr, never to stdout, prefixed by level, as TerminalText; colour only on a terminal.
void SetLogLevel(LogLevel level);
void Log(LogLevel level, std::string_view message);
inline void LogInfo(std::string_view message) { Log(LogLevel::kInfo, message); }
inline void LogWarning(std::string_view message) { Log(LogLevel::kWarning, message); }

}  // namespace mocurate
