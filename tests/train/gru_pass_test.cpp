// The pass without gradients equals the trained network, for every depth, length and chunking.

#include "train/recognisers/gru_pass.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "tests/train/trace.h"

namespace mocurate {
namespace {

struct Case {
  GruRecogniserConfig config;
  int motions, frames;
  bool lengths, hidden;
};

class GruPassOf : public ::testing::TestWithParam<Case> {};

TEST_P(GruPassOf, IsTheTrainingNetworksOutput) {
  const auto& [config, motions, frames, with_lengths, with_hidden] = GetParam();
  TracedNetwork network;
  network.options = NetworkOptions(NetworkKind::kGruRecogniser);
  network.options.recogniser.hidden = config.hidden;
  network.options.recogniser.layers = config.layers;
  network.joints = config.input / 3;
  network.classes = config.classes;
  Random random(5, "gru pass", "");
  for (Parameter parameter : GruRecogniserParameters(config)) {
    std::int64_t count = 1;
    for (const std::int64_t size : parameter.shape) count *= size;
    for (std::int64_t k = 0; k < count; ++k) parameter.value.push_back(static_cast<float>(0.1 * random.Normal()));
    network.weights.push_back(std::move(parameter));
  }
  const auto normal = [&random](std::size_t count) {
    std::vector<float> values(count);
    for (float& value : values) value = static_cast<float>(random.Normal());
    return values;
  };
  const int D = config.input, H = config.hidden, L = config.layers;
  const std::vector<float> data = normal(static_cast<std::size_t>(motions * frames * D));
  std::vector<float> states(static_cast<std::size_t>(L * motions * H), 0.0f);
  if (with_hidden) states = normal(states.size());
  std::vector<int> lengths(static_cast<std::size_t>(motions), frames);
  for (int n = 0; with_lengths && n < motions; ++n) lengths[static_cast<std::size_t>(n)] = 1 + n % frames;

  const GruPass pass(config, network.weights);
  std::vector<float> features(static_cast<std::size_t>(motions * config.features)),
      logits(static_cast<std::size_t>(motions * config.classes));
  const int cut = motions / 3;
  for (const auto& [begin, end] : {std::pair<int, int>{0, cut}, {cut, motions}}) {
    std::vector<float> hidden;  // (layers, end - begin, H)
    for (int l = 0; with_hidden && l < L; ++l) {
      const auto rows = states.begin() + static_cast<std::ptrdiff_t>(l) * motions * H;
      hidden.insert(hidden.end(), rows + static_cast<std::ptrdiff_t>(begin) * H,
                    rows + static_cast<std::ptrdiff_t>(end) * H);
    }
    const std::vector<int> read_out(lengths.begin() + begin, lengths.begin() + end);
    const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(frames) * D;
    pass.Run(data.data() + begin * stride, end - begin, frames, read_out, with_hidden ? hidden.data() : nullptr,
             features.data() + begin * config.features, logits.data() + begin * config.classes);
  }
  for (int n = 0; n < motions; ++n) {
    const int length = lengths[static_cast<std::size_t>(n)];
    Parameter motion{"motion", {length, 1, D}, {}}, hidden{"hidden", {L, 1, H}, {}};
    const auto first = data.begin() + static_cast<std::ptrdiff_t>(n) * frames * D;
    motion.value.assign(first, first + static_cast<std::ptrdiff_t>(length) * D);
    for (int l = 0; l < L; ++l) {
      const auto row = states.begin() + (static_cast<std::ptrdiff_t>(l) * motions + n) * H;
      hidden.value.insert(hidden.value.end(), row, row + H);
    }
    const auto trace = TraceParts(network, {{"motion", motion}, {"hidden", hidden}});
    ASSERT_TRUE(trace) << trace.error().Message();
    const std::vector<float>& want = trace->parts.at("logits").value;
    for (int c = 0; c < config.classes; ++c) {
      ASSERT_NEAR(logits[static_cast<std::size_t>(n * config.classes + c)], want[static_cast<std::size_t>(c)], 5e-6)
          << n;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Networks, GruPassOf,
                         ::testing::Values(Case{{72, 12, 128, 2, 30}, 13, 9, false, false},
                                           Case{{54, 13, 128, 2, 30}, 13, 9, true, true},
                                           Case{{132, 53, 256, 4, 30}, 10, 7, true, false},
                                           Case{{60, 8, 30, 1, 30}, 4, 1, false, true}));

}  // namespace
}  // namespace mocurate
