#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/random.h"

namespace mocurate {

/// One learned array of a network with its gradient, row-major float32. Names follow the papers' released code.
struct Parameter {
  std::string name;  ///< "decoder/gru.0.weight_ih"
  std::vector<std::int64_t> shape;
  std::vector<float> value;
  std::vector<float> gradient;  ///< same size as value
  double init_bound = 0.0;      ///< initial values are uniform in [-init_bound, init_bound]
};

using ParameterList = std::vector<Parameter>;

/// PyTorch's Linear: weight (out,in), bias (out), both uniform in +-1/sqrt(in).
void AddLinear(const std::string& name, int in, int out, ParameterList& parameters);

/// PyTorch's GRU weights with gates in the order r, z, n: (3 hidden, in), (3 hidden, hidden), two biases (3 hidden),
/// all uniform in +-1/sqrt(hidden). `suffix` is "" for GRUCell and "_l0" for layer 0 of GRU.
void AddGru(const std::string& prefix, const std::string& suffix, int in, int hidden, ParameterList& parameters);

/// Draws initial values in the order of the list.
void Initialise(ParameterList& parameters, Random& random);

void ClearGradients(ParameterList& parameters);

/// Number of learned values.
std::int64_t CountValues(const ParameterList& parameters);

/// Position by name; -1 when it is not there.
int FindParameter(const ParameterList& parameters, const std::string& name);

/// Replaces the values of `target` by those of `source`. Error kInconsistent naming the first parameter that is missing
/// or has another shape; `where` is shown.
Status CopyValues(const ParameterList& source, const std::string& where, ParameterList& target);

}  // namespace mocurate
