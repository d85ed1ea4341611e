// The pass without gradients gives what the layer with gradients gives, for every depth, length and cut into chunks.

#include "train/recognisers/gru_pass.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mocurate {
namespace {

struct Case {
  GruRecogniserConfig config;
  int motions, frames;
  bool lengths, hidden;
};

class GruPassOf : public ::testing::TestWithParam<Case> {};

TEST_P(GruPassOf, IsTheTrainingLayersOutput) {
  const auto& [config, motions, frames, with_lengths, with_hidden] = GetParam();
  Random random(5, "gru pass", "");
  ParameterList parameters = GruRecogniserParameters(config);
  Initialise(parameters, random);
  const auto normal = [&random](std::size_t count) {
    std::vector<float> values(count);
    for (float& value : values) value = static_cast<float>(random.Normal());
    return values;
  };
  const std::vector<float> data = normal(static_cast<std::size_t>(motions) * frames * config.input);
  GruRecogniserBatch batch;
  batch.batch = motions;
  batch.frames = frames;
  batch.motion.resize(data.size());
  for (int n = 0; n < motions; ++n) {
    for (int t = 0; t < frames; ++t) {
      std::copy_n(data.begin() + (static_cast<std::ptrdiff_t>(n) * frames + t) * config.input, config.input,
                  batch.motion.begin() + (static_cast<std::ptrdiff_t>(t) * motions + n) * config.input);
    }
  }
  if (with_lengths) {
    for (int n = 0; n < motions; ++n) batch.length.push_back(1 + n % frames);
  }
  if (with_hidden) batch.initial_hidden = normal(static_cast<std::size_t>(config.layers) * motions * config.hidden);
  std::vector<float> reference;
  GruRecogniserStep(config, batch, std::vector<int>(static_cast<std::size_t>(motions), 0), 0.0, parameters, &reference);

  const GruPass pass(config, parameters);
  std::vector<float> features(static_cast<std::size_t>(motions) * config.features),
      logits(static_cast<std::size_t>(motions) * config.classes);
  const int cut = motions / 3;
  for (const auto& [begin, end] : {std::pair<int, int>{0, cut}, {cut, motions}}) {
    std::vector<float> hidden;  // (layers, end - begin, H)
    for (int l = 0; with_hidden && l < config.layers; ++l) {
      const auto rows = batch.initial_hidden.begin() + static_cast<std::ptrdiff_t>(l) * motions * config.hidden;
      hidden.insert(hidden.end(), rows + static_cast<std::ptrdiff_t>(begin) * config.hidden,
                    rows + static_cast<std::ptrdiff_t>(end) * config.hidden);
    }
    std::vector<int> read_out(static_cast<std::size_t>(end - begin), frames);
    if (with_lengths) std::copy(batch.length.begin() + begin, batch.length.begin() + end, read_out.begin());
    const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(frames) * config.input;
    pass.Run({data.data() + begin * stride, stride, config.input}, end - begin, frames, read_out,
             with_hidden ? hidden.data() : nullptr, features.data() + begin * config.features,
             logits.data() + begin * config.classes);
  }
  ASSERT_EQ(reference.size(), logits.size());
  for (std::size_t i = 0; i < logits.size(); ++i) ASSERT_NEAR(logits[i], reference[i], 5e-6) << i;
}

INSTANTIATE_TEST_SUITE_P(Networks, GruPassOf,
                         ::testing::Values(Case{{72, 12, 128, 2, 30}, 13, 9, false, false},
                                           Case{{54, 13, 128, 2, 30}, 13, 9, true, true},
                                           Case{{132, 53, 256, 4, 30}, 10, 7, true, false},
                                           Case{{60, 8, 30, 1, 5}, 4, 1, false, true}));

}  // namespace
}  // namespace mocurate
