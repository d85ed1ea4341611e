#include "train/checkpoint/adam.h"

#include <cmath>

namespace mocurate {

void ClipGradients(double largest, ParameterList& parameters) {
  double squares = 0.0;
  for (const Parameter& parameter : parameters) {
    for (const float g : parameter.gradient) squares += static_cast<double>(g) * g;
  }
  const double norm = std::sqrt(squares);
  if (!(norm > largest)) return;
  const float factor = static_cast<float>(largest / norm);
  for (Parameter& parameter : parameters) {
    for (float& g : parameter.gradient) g *= factor;
  }
}

void Adam::Step(const AdamOptions& options, ParameterList& parameters) {
  first.resize(parameters.size());
  second.resize(parameters.size());
  ++steps;
  const double correction1 = 1.0 - std::pow(options.beta1, static_cast<double>(steps));
  const double correction2 = 1.0 - std::pow(options.beta2, static_cast<double>(steps));
  const float step = static_cast<float>(options.learning_rate / correction1);
  const float root = static_cast<float>(std::sqrt(correction2));
  const float beta1 = static_cast<float>(options.beta1), rest1 = static_cast<float>(1.0 - options.beta1);
  const float beta2 = static_cast<float>(options.beta2), rest2 = static_cast<float>(1.0 - options.beta2);
  const float decay = static_cast<float>(options.weight_decay), epsilon = static_cast<float>(options.epsilon);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::size_t count = parameters[i].value.size();
    first[i].resize(count, 0.0f);
    second[i].resize(count, 0.0f);
    float* value = parameters[i].value.data();
    const float* gradient = parameters[i].gradient.data();
    float* mean = first[i].data();
    float* square = second[i].data();
    for (std::size_t k = 0; k < count; ++k) {
      const float g = gradient[k] + decay * value[k];
      mean[k] = beta1 * mean[k] + rest1 * g;
      square[k] = beta2 * square[k] + rest2 * g * g;
      value[k] -= step * mean[k] / (std::sqrt(square[k]) / root + epsilon);
    }
  }
}

}  // namespace mocurate
