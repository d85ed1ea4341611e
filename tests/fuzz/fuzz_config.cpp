/// Any bytes as a configuration and, after the first NUL, a --set assignment. The parser must not crash, hang or read
/// files other than those of `include:`. It returns options or an error.

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/config.h"
#include "tests/base/sample_options.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  std::string text(reinterpret_cast<const char*>(bytes), size);
  std::vector<std::string> assignments;
  if (const std::size_t end = text.find('\0'); end != std::string::npos) {
    assignments.push_back(text.substr(end + 1));
    text.resize(end);
  }
  const auto node = mocurate::LoadConfig(mocurate::ConfigSource{text, "fuzz.yaml", "nowhere"}, assignments);
  if (!node) return node.error().Message().empty() ? __builtin_trap(), 0 : 0;
  const auto options = mocurate::OptionsFromConfig<mocurate::SampleOptions>(*node);
  if (!options) return 0;
  const std::string shown = mocurate::ShowOptions(*options, *node, true);
  const auto again = mocurate::LoadConfig(mocurate::ConfigSource{shown, "shown.yaml", {}});
  if (!again) __builtin_trap();
  const auto back = mocurate::OptionsFromConfig<mocurate::SampleOptions>(*again);
  if (!back || mocurate::OptionsToJson(*back) != mocurate::OptionsToJson(*options)) __builtin_trap();
  return 0;
}
