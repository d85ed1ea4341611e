#pragma once

#include <cstdlib>
#include <map>
#include <string>

namespace mocurate {

/// NAME=NUMBER arguments of a program, from the one at `first` on.
inline std::map<std::string, double> GivenNumbers(int argc, char** argv, int first) {
  std::map<std::string, double> given;
  for (int i = first; i < argc; ++i) {
    const std::string text = argv[i];
    const std::size_t at = text.find('=');
    given[text.substr(0, at)] = at == std::string::npos ? 0.0 : std::atof(text.c_str() + at + 1);
  }
  return given;
}

/// The text of the argument NAME=TEXT, from the one at `first` on; empty where it is not given.
inline std::string GivenText(int argc, char** argv, int first, const std::string& name) {
  for (int i = first; i < argc; ++i) {
    const std::string text = argv[i];
    if (text.rfind(name + "=", 0) == 0) return text.substr(name.size() + 1);
  }
  return {};
}

}  // namespace mocurate
