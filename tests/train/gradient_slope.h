#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "tests/train/trace.h"

namespace mocurate {

/// Loss once the weights whose names begin with `part` have moved by `step` times their gradient.
inline double LossAfterStep(const TracedNetwork& network, const TraceBatch& batch, const StepTrace& trace,
                            const std::string& part, double step) {
  TracedNetwork moved = network;
  for (Parameter parameter : InitialValues(network)) {
    const auto gradient = trace.gradients.find(parameter.name);
    if (parameter.name.rfind(part, 0) != 0 || gradient == trace.gradients.end()) continue;
    for (std::size_t i = 0; i < parameter.value.size(); ++i) {
      parameter.value[i] += static_cast<float>(step * gradient->second.value[i]);
    }
    moved.weights.push_back(std::move(parameter));
  }
  const auto after = TraceStep(moved, batch);
  return after ? after->total : std::nan("");
}

/// Norm of the gradient by the weights whose names begin with `part`.
inline double GradientNorm(const StepTrace& trace, const std::string& part) {
  double square = 0.0;
  for (const auto& [name, gradient] : trace.gradients) {
    if (name.rfind(part, 0) != 0) continue;
    for (const float value : gradient.value) square += static_cast<double>(value) * value;
  }
  return std::sqrt(square);
}

/// The slope of the loss along the gradient, by a central difference, is the gradient's norm.
inline void ExpectSlopeOfGradient(const TracedNetwork& network, const TraceBatch& batch, const StepTrace& trace,
                                  const std::string& part) {
  const double norm = GradientNorm(trace, part), step = 3e-4 / norm;
  const double slope =
      (LossAfterStep(network, batch, trace, part, step) - LossAfterStep(network, batch, trace, part, -step)) / 6e-4;
  EXPECT_NEAR(slope, norm, 0.03 * norm + 1e-3) << part;
}

}  // namespace mocurate
