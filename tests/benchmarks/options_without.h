#pragma once

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "fitting/options.h"

namespace mocurate::benchmarks {

/// Options of a fit without what MOCURATE_WITHOUT names, separated by commas (unset: the defaults): rules of
/// `fitting.without`, or options by their path below `fitting` (repair.swaps, keypoints.audit.clocks), which become
/// false, off or none by their kind. Ends the program with a message for an unknown name.
inline FittingOptions OptionsWithout() {
  const char* given = std::getenv("MOCURATE_WITHOUT");
  nlohmann::json json = OptionsToJson(FittingOptions{});
  std::istringstream names(given != nullptr ? given : "");
  for (std::string name; std::getline(names, name, ',');) {
    if (name.find('.') == std::string::npos) {
      json["without"].push_back(name);
      continue;
    }
    nlohmann::json* option = &json;
    std::istringstream path(name);
    for (std::string part; option != nullptr && std::getline(path, part, '.');) {
      option = option->contains(part) ? &(*option)[part] : nullptr;
    }
    if (option == nullptr) std::fprintf(stderr, "MOCURATE_WITHOUT: no option fitting.%s\n", name.c_str()), std::exit(2);
    *option = option->is_boolean()  ? nlohmann::json(false)
              : option->is_string() ? nlohmann::json("off")
                                    : nlohmann::json(nullptr);
  }
  const auto options = OptionsFromJson<FittingOptions>(json, "MOCURATE_WITHOUT");
  if (!options) std::fprintf(stderr, "%s\n", options.error().Message().c_str()), std::exit(2);
  return *options;
}

}  // namespace mocurate::benchmarks
