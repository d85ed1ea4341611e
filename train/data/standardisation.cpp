#include "train/data/standardisation.h"

#include <algorithm>
#include <cmath>

namespace mocurate {

Standardisation Standardisation::Of(const RecogniserOptions& options, const std::vector<TrainingClip>& clips) {
  const std::size_t dim = 3 * static_cast<std::size_t>(clips.front().clip->motion->joint_count());
  std::vector<double> sum(dim, 0.0), squares(dim, 0.0);
  double count = 0.0;
  for (int row = 0; row < static_cast<int>(clips.size()); ++row) {
    const GruRecogniserBatch one = MakeRecogniserBatch(options, clips, {row}, 0, false);
    for (std::size_t i = 0; i < one.motion.size(); ++i) {
      const double value = one.motion[i];
      sum[i % dim] += value;
      squares[i % dim] += value * value;
    }
    count += one.frames;
  }
  Standardisation result;
  for (std::size_t k = 0; k < dim; ++k) {
    const double mean = sum[k] / count;
    result.mean.push_back(static_cast<float>(mean));
    result.spread.push_back(
        static_cast<float>(std::max(0.02, std::sqrt(std::max(0.0, squares[k] / count - mean * mean)))));
  }
  return result;
}

void Standardisation::Apply(std::vector<float>& motion) const {
  const std::size_t dim = mean.size();
  for (std::size_t begin = 0; begin < motion.size(); begin += dim) {
    for (std::size_t k = 0; k < dim; ++k) motion[begin + k] = (motion[begin + k] - mean[k]) / spread[k];
  }
}

void Standardisation::Fold(ParameterList& parameters) const {
  Parameter& weight = parameters[static_cast<std::size_t>(FindParameter(parameters, "recurrent.weight_ih_l0"))];
  Parameter& bias = parameters[static_cast<std::size_t>(FindParameter(parameters, "recurrent.bias_ih_l0"))];
  const std::size_t dim = mean.size();
  for (std::size_t row = 0; row < bias.value.size(); ++row) {
    double shift = 0.0;
    for (std::size_t k = 0; k < dim; ++k) {
      float& w = weight.value[row * dim + k];
      w /= spread[k];
      shift += static_cast<double>(w) * mean[k];
    }
    bias.value[row] -= static_cast<float>(shift);
  }
}

}  // namespace mocurate
