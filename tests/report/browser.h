#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/report/builders.h"

namespace mocurate::test {

inline constexpr const char* kChromium = "/usr/bin/chromium";

/// Where the recorded data are available, a missing program is a failure.
inline bool HasProgram(const char* program) {
  if (std::filesystem::exists(program)) return true;
  EXPECT_EQ(std::getenv("MOCURATE_DATA"), nullptr) << program << " is missing: scripts/install.sh tests";
  return false;
}

inline bool HasBrowser() { return HasProgram(kChromium); }

/// Chromium that tests work by keys and clicks.
inline bool HasDrivenBrowser() {
  return HasBrowser() && HasProgram("/usr/bin/chromedriver") && HasProgram("/usr/lib/python3/dist-packages/selenium");
}

/// Opens index.html of the folder in a browser without network access; its document and its log are written to files.
/// A browser that hangs is started once more.
inline int Browse(const ScratchFolder& place, const std::string& what) {
  const std::string folder = place / "";
  const std::string command =
      "timeout 60 " + std::string(kChromium) +
      " --headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking"
      " --disable-component-update --disable-sync --enable-logging=stderr --user-data-dir='" +
      folder + "profile' " + what + " --window-size=1200,2000 'file://" + folder + "index.html' > '" + folder +
      "dom.html' 2> '" + folder + "log.txt'";
  constexpr int kTimedOut = 124 << 8;
  const int status = std::system(command.c_str());
  if (status != kTimedOut) return status;
  std::filesystem::remove_all(place / "profile");
  return std::system(command.c_str());
}

}  // namespace mocurate::test
