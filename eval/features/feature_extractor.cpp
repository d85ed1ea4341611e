#include "eval/features/feature_extractor.h"

#include "core/base/random.h"
#include "train/recognisers/recogniser_input.h"

namespace mocurate {

Expected<Recognised> Recognise(const Recogniser& recogniser, const std::vector<const Motion*>& motions,
                               const RecogniserHidden& hidden, std::uint64_t seed) {
  const int frames = recogniser.input_frames();
  const int dim = recogniser.input_size();
  std::vector<float> inputs;
  inputs.reserve(motions.size() * frames * dim);
  for (std::size_t i = 0; i < motions.size(); ++i) {
    Random random(seed, "crop", std::to_string(i));
    const std::vector<float> input = RecogniserInput(*motions[i], recogniser.input_kind(), frames, random);
    if (input.size() != static_cast<std::size_t>(frames) * dim) {
      return Fail(ErrorCode::kInconsistent,
                  "motions have " + std::to_string(motions[i]->joint_count()) + " joints, the recogniser reads " +
                      std::to_string(dim / 3),
                  "recogniser", "evaluate motions of the skeleton the recogniser was trained on");
    }
    inputs.insert(inputs.end(), input.begin(), input.end());
  }
  const auto output = recogniser.Run(inputs.data(), static_cast<int>(motions.size()), frames, dim, hidden);
  if (!output) return Forward(output);
  Recognised recognised;
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  recognised.features =
      Eigen::Map<const RowMajor>(output->features.data(), output->count, output->feature_size).cast<double>();
  for (int i = 0; i < output->count; ++i) recognised.predicted.push_back(output->Predicted(i));
  return recognised;
}

}  // namespace mocurate
