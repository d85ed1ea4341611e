#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace mocurate {

/// One learned array of a network, row-major float32. Names follow the papers' released code.
struct Parameter {
  std::string name;  ///< "decoder.gru.0.weight_ih"
  std::vector<std::int64_t> shape;
  std::vector<float> value;
};

using ParameterList = std::vector<Parameter>;

/// Number of learned values.
std::int64_t CountValues(const ParameterList& parameters);

/// The same, grouped by the first part of their names: "prior.embed.weight" is of "prior".
std::map<std::string, std::int64_t> CountByPart(const ParameterList& parameters);

/// Position by name; -1 when it is not there.
int FindParameter(const ParameterList& parameters, const std::string& name);

/// "3x5"
std::string ShapeText(const std::vector<std::int64_t>& shape);

}  // namespace mocurate
