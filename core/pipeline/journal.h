#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// Now in UTC: "2024-05-01T12:34:56.789Z".
std::string TimeNow();

/// Append-only file of JSON lines; each line is one write, so that a kill leaves complete lines.
class Journal {
 public:
  Journal() = default;
  Journal(Journal&& other) noexcept;
  Journal& operator=(Journal&& other) noexcept;
  ~Journal();

  /// Error kCannotWrite.
  static Expected<Journal> Open(const std::filesystem::path& file);
  /// Adds the time to `entry` and appends it. Error kCannotWrite.
  Status Add(nlohmann::json entry);

 private:
  int file_ = -1;
  std::filesystem::path path_;
};

}  // namespace mocurate
