#include "train/checkpoint/parameters.h"

namespace mocurate {

std::int64_t CountValues(const ParameterList& parameters) {
  std::int64_t count = 0;
  for (const Parameter& parameter : parameters) count += static_cast<std::int64_t>(parameter.value.size());
  return count;
}

std::map<std::string, std::int64_t> CountByPart(const ParameterList& parameters) {
  std::map<std::string, std::int64_t> counts;
  for (const Parameter& parameter : parameters) {
    counts[parameter.name.substr(0, parameter.name.find('.'))] += static_cast<std::int64_t>(parameter.value.size());
  }
  return counts;
}

int FindParameter(const ParameterList& parameters, const std::string& name) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

std::string ShapeText(const std::vector<std::int64_t>& shape) {
  std::string text;
  for (const std::int64_t size : shape) text += (text.empty() ? "" : "x") + std::to_string(size);
  return text.empty() ? "one number" : text;
}

}  // namespace mocurate
