#include "train/checkpoint/parameters.h"

#include <algorithm>
#include <cmath>

namespace mocurate {
namespace {

void Add(const std::string& name, std::vector<std::int64_t> shape, double bound, ParameterList& parameters) {
  Parameter parameter;
  parameter.name = name;
  std::size_t count = 1;
  for (const std::int64_t size : shape) count *= static_cast<std::size_t>(size);
  parameter.shape = std::move(shape);
  parameter.value.assign(count, 0.0f);
  parameter.gradient.assign(count, 0.0f);
  parameter.init_bound = bound;
  parameters.push_back(std::move(parameter));
}

std::string ShapeText(const std::vector<std::int64_t>& shape) {
  std::string text;
  for (const std::int64_t size : shape) text += (text.empty() ? "" : "x") + std::to_string(size);
  return text.empty() ? "1" : text;
}

}  // namespace

void AddLinear(const std::string& name, int in, int out, ParameterList& parameters) {
  const double bound = 1.0 / std::sqrt(static_cast<double>(in));
  Add(name + ".weight", {out, in}, bound, parameters);
  Add(name + ".bias", {out}, bound, parameters);
}

void AddGru(const std::string& prefix, const std::string& suffix, int in, int hidden, ParameterList& parameters) {
  const double bound = 1.0 / std::sqrt(static_cast<double>(hidden));
  Add(prefix + "weight_ih" + suffix, {3 * hidden, in}, bound, parameters);
  Add(prefix + "weight_hh" + suffix, {3 * hidden, hidden}, bound, parameters);
  Add(prefix + "bias_ih" + suffix, {3 * hidden}, bound, parameters);
  Add(prefix + "bias_hh" + suffix, {3 * hidden}, bound, parameters);
}

void Initialise(ParameterList& parameters, Random& random) {
  for (Parameter& parameter : parameters) {
    for (float& value : parameter.value) {
      value = static_cast<float>(random.Uniform(-parameter.init_bound, parameter.init_bound));
    }
  }
}

void ClearGradients(ParameterList& parameters) {
  for (Parameter& parameter : parameters) std::fill(parameter.gradient.begin(), parameter.gradient.end(), 0.0f);
}

std::int64_t CountValues(const ParameterList& parameters) {
  std::int64_t count = 0;
  for (const Parameter& parameter : parameters) count += static_cast<std::int64_t>(parameter.value.size());
  return count;
}

int FindParameter(const ParameterList& parameters, const std::string& name) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

Status CopyValues(const ParameterList& source, const std::string& where, ParameterList& target) {
  for (Parameter& parameter : target) {
    const int found = FindParameter(source, parameter.name);
    if (found < 0) return Fail(ErrorCode::kInconsistent, "parameter '" + parameter.name + "' is missing", where);
    if (source[found].shape != parameter.shape || source[found].value.size() != parameter.value.size()) {
      return Fail(ErrorCode::kInconsistent,
                  "parameter '" + parameter.name + "' is " + ShapeText(source[found].shape) + ", the network has " +
                      ShapeText(parameter.shape),
                  where);
    }
    parameter.value = source[found].value;
  }
  return {};
}

}  // namespace mocurate
