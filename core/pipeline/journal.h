#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// Now in UTC: "2024-05-01T12:34:56.789Z".
std::string TimeNow();

/// Calls `visit` with each line of a journal that is a JSON object. Others are passed over, as a full disk may have cut
/// one short, and so are lines of more than 16 MiB. No line for a file that cannot be read.
void ForEachLine(const std::filesystem::path& file, const std::function<void(const nlohmann::json& line)>& visit);

/// A field of such a line; `otherwise` where it is missing or of another type.
std::string TextField(const nlohmann::json& line, const char* name, std::string otherwise = {});
double NumberField(const nlohmann::json& line, const char* name, double otherwise = 0.0);

/// Append-only file of JSON lines; each line is one write, so that a kill leaves complete lines.
class Journal {
 public:
  Journal() = default;
  Journal(Journal&& other) noexcept;
  Journal& operator=(Journal&& other) noexcept;
  ~Journal();

  /// Error kCannotWrite, also for a link.
  static Expected<Journal> Open(const std::filesystem::path& file);
  /// Adds the time to `entry` and appends it. Error kCannotWrite.
  Status Add(nlohmann::json entry);

 private:
  int file_ = -1;
  std::filesystem::path path_;
};

}  // namespace mocurate
