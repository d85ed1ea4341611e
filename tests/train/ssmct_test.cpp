// SSMCT's stand-in: its fill is exact, known frames stay, padding and hidden frames change nothing, gradients are
// slopes.

#include "train/networks/ssmct.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include <cmath>
#include <numeric>

#include "core/base/random.h"
#include "tests/train/gradient_slope.h"
#include "tests/train/network_parts.h"
#include "train/layers/rotations.h"

namespace mocurate {
namespace {

using torch::Tensor;

constexpr int kChainJoints = 4, kLongestMotion = 12, kChainNumbers = 6 * kChainJoints + 3;

/// Width 16, two layers, motions of 12 frames of a chain of four joints.
TracedNetwork SmallSsmct() {
  TracedNetwork network;
  network.options = NetworkOptions(NetworkKind::kSsmct);
  network.options.data.frames = kLongestMotion;
  network.options.ssmct.width = 16;
  network.options.ssmct.layers = 2;
  network.options.ssmct.feed_forward = 32;
  network.options.ssmct.dropout = 0.0;
  network.joints = kChainJoints;
  for (int j = 0; j < kChainJoints; ++j) {
    network.parents.push_back(j - 1);
    network.rest_offset.emplace_back(0.0, 0.1, 0.01 * j);
  }
  return network;
}

std::shared_ptr<Network> BuildSmallSsmct() {
  const TracedNetwork traced = SmallSsmct();
  NetworkSizes sizes;
  sizes.joints = traced.joints;
  sizes.parents = traced.parents;
  sizes.rest_offset = traced.rest_offset;
  return MakeNetwork(traced.options, sizes);
}

std::int64_t CountOfParameters(const TracedNetwork& network) {
  std::int64_t count = 0;
  for (const auto& [name, shape] : ShapesOf(network)) {
    count += std::accumulate(shape.begin(), shape.end(), std::int64_t{1}, std::multiplies<>());
  }
  return count;
}

/// (L,B,3J+3) rotation vectors and places.
Tensor RandomFrames(int frames, int motions, const char* name) {
  Random random(5, name);
  const Tensor values = torch::empty({frames, motions, 3 * kChainJoints + 3});
  for (std::int64_t i = 0; i < values.numel(); ++i) {
    values.data_ptr<float>()[i] = static_cast<float>(random.Uniform(-0.8, 0.8));
  }
  return values;
}

Tensor PartsTensor(const std::vector<std::int64_t>& parts) { return torch::tensor(parts, torch::kInt64).view({-1, 3}); }

Tensor RotationsOfFrames(const Tensor& frames) {
  const Tensor vectors = frames.slice(2, 0, 3 * kChainJoints);
  return MatricesOf(vectors.reshape({frames.size(0), frames.size(1), kChainJoints, 3}), PoseChoice::kAxisAngle);
}

Tensor PlacesOfFrames(const Tensor& frames) { return frames.slice(2, 3 * kChainJoints); }

double LargestApart(const Tensor& a, const Tensor& b) { return (a - b).abs().max().item<double>(); }

Tensor FilledBy(Network& network, const Tensor& frames, const std::vector<std::int64_t>& parts) {
  const torch::NoGradGuard no_gradient;
  return NetworkParts::Of(network, {{"frames", frames}, {"parts", PartsTensor(parts)}}).at("filled");
}

TraceBatch ThreeMotions(const Tensor& frames, std::size_t steps) {
  TraceBatch batch;
  batch.frames = kLongestMotion;
  batch.features.assign(frames.data_ptr<float>(), frames.data_ptr<float>() + frames.numel());
  batch.label = {0, 1, 2};
  batch.parts = {5, 2, 4, 4, 3, 5, 6, 3, 2};
  batch.word.assign(9, 0);
  batch.draws.resize(steps);
  return batch;
}

TEST(Ssmct, FillOfAConstantVelocityTurnIsExact) {
  const std::int64_t L = 10, B = 2;
  const Tensor velocity = torch::tensor({0.3f, -0.1f, 0.2f, 0.0f, 0.5f, 0.0f, -0.2f, 0.2f, 0.1f, 0.0f, 0.0f, 0.0f});
  const Tensor time = torch::arange(L, torch::kFloat32).view({L, 1, 1, 1});
  const Tensor first = RotationsOfFrames(RandomFrames(1, 2, "first"));  // (1,B,J,3,3)
  const Tensor rotation =
      first.matmul(MatricesOf(time * velocity.view({1, 1, kChainJoints, 3}), PoseChoice::kAxisAngle));
  const Tensor place = time.squeeze(3) * torch::tensor({0.1f, -0.02f, 0.3f}) + torch::ones({L, B, 3});
  const Tensor parts = PartsTensor({3, 4, 3, 1, 5, 2});

  // Nothing of the transition is read.
  Tensor hidden_rotation = rotation.clone(), hidden_place = place.clone();
  const std::pair<int, int> transitions[] = {{3, 7}, {1, 6}};
  for (int b = 0; b < B; ++b) {
    hidden_rotation.select(1, b).slice(0, transitions[b].first, transitions[b].second).fill_(9.0);
    hidden_place.select(1, b).slice(0, transitions[b].first, transitions[b].second).fill_(9.0);
  }
  const FilledMotion filled = SlerpFill(hidden_rotation, hidden_place, parts);
  EXPECT_LE(LargestApart(filled.rotation, rotation), 1e-6);
  EXPECT_LE(LargestApart(filled.place, place), 1e-6);
}

TEST(Ssmct, KnownFramesAreCopiedAndHiddenOnesAreNotRead) {
  const auto network = BuildSmallSsmct();
  const Tensor frames = RandomFrames(kLongestMotion, 2, "known");
  const std::vector<std::int64_t> parts = {5, 2, 4, 4, 3, 5};
  const Tensor filled = FilledBy(*network, frames, parts);
  ASSERT_EQ(filled.sizes().vec(), (std::vector<std::int64_t>{kLongestMotion, 2, kChainNumbers}));
  const Tensor rows = torch::cat({Columns6D(RotationsOfFrames(frames)).flatten(-2), PlacesOfFrames(frames)}, 2);
  Tensor changed = frames.clone();
  for (int b = 0; b < 2; ++b) {
    const std::int64_t *part = parts.data() + 3 * b, begin = part[0], end = begin + part[1], last = end + part[2];
    const auto apart = [&](std::int64_t from, std::int64_t to) {
      return from < to ? LargestApart(filled.select(1, b).slice(0, from, to), rows.select(1, b).slice(0, from, to))
                       : 0.0;
    };
    EXPECT_EQ(apart(0, begin), 0.0);
    EXPECT_EQ(apart(end, last), 0.0);
    for (std::int64_t t = begin; t < end; ++t) EXPECT_GT(apart(t, t + 1), 1e-3) << "the network predicts this frame";
    EXPECT_EQ(filled.select(1, b).slice(0, last).abs().sum().item<double>(), 0.0);
    changed.select(1, b).slice(0, begin, end).add_(0.3);
    changed.select(1, b).slice(0, last).add_(0.3);
  }
  EXPECT_EQ(LargestApart(FilledBy(*network, changed, parts), filled), 0.0);
}

TEST(Ssmct, PaddingDoesNotChangeAMotion) {
  const auto network = BuildSmallSsmct();
  const Tensor frames = RandomFrames(kLongestMotion, 2, "padding");
  const Tensor together = FilledBy(*network, frames, {2, 3, 2, 4, 3, 5});
  const Tensor alone = FilledBy(*network, frames.slice(0, 0, 7).slice(1, 0, 1), {2, 3, 2});
  EXPECT_LE(LargestApart(together.slice(0, 0, 7).slice(1, 0, 1), alone), 1e-5);
}

TEST(Ssmct, AnswerIsTheFilledTransition) {
  const auto network = BuildSmallSsmct();
  const Tensor frames = RandomFrames(kLongestMotion, 2, "answer");
  const std::vector<std::int64_t> parts = {5, 2, 4, 4, 3, 5};
  const Tensor filled = FilledBy(*network, frames, parts);

  // 9 frames precede the transition of the first motion: only its last 6 fit into the 12 of the network.
  const auto request = [&](int earlier) {
    const Tensor earlier_frames = torch::cat({RandomFrames(earlier, 2, "earlier"), frames});
    const auto padded_part = [&](const Tensor& x, std::int64_t first, std::int64_t second, std::int64_t count) {
      Tensor part = torch::stack(
          {x.select(1, 0).slice(0, first, first + count), x.select(1, 1).slice(0, second, second + count)}, 1);
      return part.contiguous();
    };
    RequestBatch requests;
    requests.parts = PartsTensor(parts);
    requests.parts.select(1, 0).add_(earlier);
    requests.label = requests.parts.select(1, 0);
    requests.bone_length = torch::full({2, kChainJoints}, 0.25);
    requests.bone_length.select(1, 0).zero_();
    const Tensor previous = padded_part(earlier_frames, 0, 0, 5 + earlier), next = padded_part(frames, 7, 7, 5);
    requests.previous_rotation = RotationsOfFrames(previous);
    requests.previous_place = PlacesOfFrames(previous);
    requests.next_rotation = RotationsOfFrames(next);
    requests.next_place = PlacesOfFrames(next);
    return requests;
  };
  network->eval();
  const torch::NoGradGuard no_gradient;
  Draws draws(std::vector<std::uint64_t>{1, 2});
  const Motions motions = network->Answer(request(0), draws);
  ASSERT_EQ(motions.output.sizes().vec(), (std::vector<std::int64_t>{3, 2, kChainNumbers}));
  ASSERT_EQ(motions.joints.sizes().vec(), (std::vector<std::int64_t>{3, 2, 3 * kChainJoints}));
  EXPECT_LE(LargestApart(motions.output.select(1, 0).slice(0, 0, 2), filled.select(1, 0).slice(0, 5, 7)), 1e-5);
  EXPECT_LE(LargestApart(motions.output.select(1, 1), filled.select(1, 1).slice(0, 4, 7)), 1e-5);

  const Tensor square = motions.rotation.matmul(motions.rotation.transpose(-1, -2));
  EXPECT_LE(LargestApart(square, torch::eye(3).expand_as(square)), 1e-5);
  const Tensor joints = motions.joints.view({3, 2, kChainJoints, 3});
  EXPECT_LE(LargestApart(joints.select(2, 0), motions.output.slice(2, kChainNumbers - 3)), 1e-6);
  const Tensor bones = (joints.slice(2, 1) - joints.slice(2, 0, -1)).norm(2, 3);
  EXPECT_LE(LargestApart(bones, torch::full_like(bones, 0.25)), 1e-5);

  // The second motion has 12 frames already: what is before them is not read. The first has 11, one more is.
  const Motions longer = network->Answer(request(4), draws);
  EXPECT_LE(LargestApart(longer.output.select(1, 1), motions.output.select(1, 1)), 1e-5);
  EXPECT_GT(LargestApart(longer.output.select(1, 0), motions.output.select(1, 0)), 1e-5);
}

TEST(Ssmct, HasTheStatedNumberOfParameters) {
  // G = 27, E = 16, H = 32: convolutions 3 G E + E and 3 E G + G; positions 12 E, tags 3 E; two layers of
  // 4 (E E + E) + 2 E H + H + E + 4 E.
  EXPECT_EQ(CountOfParameters(SmallSsmct()), 1312 + 1323 + 192 + 48 + 2 * 2224);
  // G = 315, E = 512, H = 2048, 120 frames, eight layers.
  TracedNetwork full = SmallSsmct();
  full.options = NetworkOptions(NetworkKind::kSsmct);
  full.joints = 52;
  EXPECT_EQ(CountOfParameters(full), 484352 + 484155 + 61440 + 1536 + 8 * 3152384);
}

TEST(Ssmct, LossRisesAlongItsGradientAsTheGradientSays) {
  const TracedNetwork network = SmallSsmct();
  const Tensor frames = RandomFrames(kLongestMotion, 3, "gradient");
  const TraceBatch batch = ThreeMotions(frames, 1);
  const auto trace = TraceStep(network, batch);
  ASSERT_TRUE(trace) << trace.error().Message();
  for (const char* part : {"input.", "positions", "tags", "encoder.", "output."}) {
    EXPECT_GT(GradientNorm(*trace, part), 1e-3) << part;
    ExpectSlopeOfGradient(network, batch, *trace, part);
  }

  // The terms are the means that the header states, here of eight frames.
  const auto& filled = trace->outputs.at("filled").value;
  const Tensor rows = torch::cat({Columns6D(RotationsOfFrames(frames)).flatten(-2), PlacesOfFrames(frames)}, 2);
  double sum = 0.0;
  for (int b = 0; b < 3; ++b) {
    const int begin = batch.parts[static_cast<std::size_t>(3 * b)];
    for (int t = begin; t < begin + batch.parts[static_cast<std::size_t>(3 * b + 1)]; ++t) {
      for (int k = 0; k < kChainNumbers; ++k) {
        const auto at = static_cast<std::size_t>((3 * t + b) * kChainNumbers + k);
        sum += std::fabs(filled[at] - rows[t][b][k].item<double>());
      }
    }
  }
  EXPECT_NEAR(trace->terms.at("pose"), sum / (8.0 * kChainNumbers), 1e-6);
  EXPECT_NEAR(trace->total, trace->terms.at("pose") + trace->terms.at("joint"), 1e-6);
}

TEST(Ssmct, LossReadsRotationsAndPlacesOfABatch) {
  const auto network = BuildSmallSsmct();
  const Tensor frames = RandomFrames(kLongestMotion, 2, "batch");
  Batch features, rotations;
  features.label = rotations.label = torch::zeros({2}, torch::kInt64);
  features.whole = rotations.whole = 2;
  features.parts = rotations.parts = PartsTensor({5, 2, 4, 4, 3, 5});
  features.features = frames;
  rotations.rotation = RotationsOfFrames(frames);
  rotations.motion = torch::cat({PlacesOfFrames(frames), torch::ones({kLongestMotion, 2, 3 * kChainJoints - 3})}, 2);
  Draws draws(1, 0, 0, 0);
  EXPECT_FLOAT_EQ(network->Loss(features, draws, 0).total.item<float>(),
                  network->Loss(rotations, draws, 0).total.item<float>());
}

}  // namespace
}  // namespace mocurate
