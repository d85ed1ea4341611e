#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace mocurate {

/// A script, style or text of report/viewer/, or three.min.js, as it was when the program was built.
std::string_view PageFile(std::string_view name);

/// The styles of all pages (page.css), then these.
std::string PageStyles(std::initializer_list<std::string_view> names = {});

/// Elements of scripts, in order: classic scripts, which work from file://.
std::string PageScripts(const std::vector<std::string_view>& names);

}  // namespace mocurate
