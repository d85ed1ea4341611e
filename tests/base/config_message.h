#pragma once

#include "core/base/config.h"
#include "tests/base/sample_options.h"

namespace mocurate {

inline Expected<SampleOptions> ReadSample(const std::string& yaml, const std::vector<std::string>& assignments = {}) {
  const Expected<ConfigNode> node = LoadConfig(ConfigSource{yaml, "c.yaml", "folder"}, assignments);
  if (!node) return Forward(node);
  return OptionsFromConfig<SampleOptions>(*node);
}

/// The whole message, empty without an error.
inline std::string MessageOf(const std::string& yaml, const std::vector<std::string>& assignments = {}) {
  const Expected<SampleOptions> options = ReadSample(yaml, assignments);
  return options ? "" : options.error().Message();
}

}  // namespace mocurate
