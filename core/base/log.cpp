#include "core/base/log.h"

#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include <memory>
#include <string>

#include "core/base/terminal.h"

namespace mocurate {
namespace {

spdlog::level::level_enum LevelOf(LogLevel level) {
  constexpr spdlog::level::level_enum kLevels[] = {spdlog::level::err, spdlog::level::warn, spdlog::level::info,
                                                   spdlog::level::debug};
  return kLevels[static_cast<std::size_t>(level)];
}

/// The stderr of the process is one; so is its logger.
spdlog::logger& StderrLogger() {
  static const std::shared_ptr<spdlog::logger> logger = [] {
    auto made = std::make_shared<spdlog::logger>("mocurate", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
    made->set_pattern("%^%l%$: %v");
    made->set_level(spdlog::level::info);
    made->flush_on(spdlog::level::trace);
    return made;
  }();
  return *logger;
}

}  // namespace

void SetLogLevel(LogLevel level) { StderrLogger().set_level(LevelOf(level)); }

void Log(LogLevel level, std::string_view message) {
  const std::string text = TerminalText(message);
  StderrLogger().log(LevelOf(level), spdlog::string_view_t(text.data(), text.size()));
}

}  // namespace mocurate
