#pragma once

#include <filesystem>
#include <string>

#include "core/base/error.h"

namespace mocurate {

/// A picture (PNG, 1300 pixels wide) of an HTML page as Chromium shows it. The browser is $MOCURATE_BROWSER, else
/// chromium, chromium-browser or google-chrome of the PATH. Errors kMissingOnHost without one, kInternal where it
/// writes no picture.
/// `corner` is written below the page.
Status WriteScreen(const std::filesystem::path& page, const std::string& corner, const std::filesystem::path& picture);

}  // namespace mocurate
