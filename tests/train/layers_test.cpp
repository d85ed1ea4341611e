// Each optimised layer equals its plain form, forward and backward.

#include <gtest/gtest.h>
#include <torch/torch.h>

#include "tests/train/chains.h"
#include "train/layers/attention.h"
#include "train/layers/body.h"
#include "train/layers/draws.h"
#include "train/layers/dropout.h"
#include "train/layers/frames.h"
#include "train/layers/gru_layer.h"
#include "train/layers/lie_function.h"
#include "train/layers/rotations.h"

namespace mocurate {
namespace {

using torch::Tensor;

void ExpectAlike(const std::vector<Tensor>& a, const std::vector<Tensor>& b, double tolerance, const char* what) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double scale = std::max(1e-6, b[i].abs().max().item<double>());
    EXPECT_LE((a[i] - b[i]).abs().max().item<double>(), tolerance * scale) << what << " " << i;
  }
}

TEST(GruLayer, EqualsItsPlainFormWithAllGradients) {
  torch::manual_seed(3);
  for (const auto& [T, B, I, H] : {std::array<std::int64_t, 4>{1, 1, 3, 5}, {7, 4, 6, 8}, {3, 9, 20, 16}}) {
    torch::nn::GRU gru(I, H);
    const Tensor input = torch::randn({T, B, I}, torch::requires_grad());
    const Tensor state = torch::randn({B, H}, torch::requires_grad());
    const Tensor weight = torch::randn({T, B, H});
    std::vector<Tensor> inputs = gru->parameters();
    inputs.insert(inputs.end(), {input, state});
    std::vector<std::vector<Tensor>> results;
    for (const int form : {0, 1, 2}) {
      const GruWeights weights(gru, 0);
      Tensor output = form == 0 ? GruLayer(input, state, weights) : PlainGruLayer(input, state, weights);
      if (form == 2) {  // frame by frame
        GruFrames frames(weights, T, B);
        std::vector<Tensor> states = {state};
        for (const Tensor& frame : input.unbind(0)) states.push_back(frames.Step(frame, states.back()));
        output = torch::stack(states).slice(0, 1);
      }
      results.push_back(torch::autograd::grad({(output * weight).sum()}, inputs));
      results.back().push_back(output.detach());
    }
    ExpectAlike(results[0], results[1], 2e-5, "GRU");
    ExpectAlike(results[2], results[1], 2e-5, "frames of a GRU");
    const Tensor library = std::get<0>(gru->forward(input, state.unsqueeze(0)));
    ExpectAlike({results[0].back()}, {library}, 1e-5, "libtorch's GRU");
  }
}

TEST(GruWeights, OfACellBehindALinearLayerAreBothInOne) {
  torch::manual_seed(4);
  const torch::nn::Linear embedding(6, 5);
  const torch::nn::GRUCell cell(5, 7);
  const Tensor input = torch::randn({4, 6}), state = torch::randn({4, 7});
  const Tensor one = GruStep(input, state, GruWeights(cell, embedding));
  torch::nn::Linear layer = embedding;
  torch::nn::GRUCell second = cell;
  ExpectAlike({one.detach()}, {second->forward(layer->forward(input), state).detach()}, 1e-5, "cell");
}

TEST(LieJoints, EqualTheirPlainFormWithTheGradient) {
  torch::manual_seed(5);
  const LieLayer layer(HumanAct12Chains(), LieExp::kReleased);
  const Tensor parameters = torch::randn({6, 72}, torch::requires_grad());
  const Tensor lengths = torch::rand({6, 24}) + 0.1, weight = torch::randn({6, 72});
  std::vector<std::vector<Tensor>> results;
  for (const bool plain : {false, true}) {
    const Tensor joints = plain ? PlainLieJoints(layer, parameters, lengths) : LieJoints(layer, parameters, lengths);
    results.push_back(torch::autograd::grad({(joints * weight).sum()}, {parameters}));
    results.back().push_back(joints.detach());
  }
  ExpectAlike(results[0], results[1], 1e-5, "joints");
  Tensor measured = LieBoneLengths(layer, results[0].back());
  EXPECT_LE((measured - lengths).slice(1, 1).abs().max().item<double>(), 1e-5);
}

TEST(TreeKinematics, EqualsItsPlainFormWithAllGradients) {
  torch::manual_seed(6);
  const std::vector<int> parents = {-1, 0, 1, 0, 3, 3, 2};
  const Tensor rotation = torch::randn({5, 7, 3, 3}, torch::requires_grad());
  const Tensor of_rotation = torch::randn({5, 7, 3, 3}), of_joints = torch::randn({5, 7, 3});
  for (const bool of_frames : {false, true}) {
    const Tensor offsets =
        of_frames ? torch::randn({5, 7, 3}, torch::requires_grad()) : torch::randn({7, 3}, torch::requires_grad());
    for (const int part : {0, 1, 2}) {  // the gradient comes from both results, from one, from the other
      std::vector<std::vector<Tensor>> results;
      for (const bool plain : {false, true}) {
        const auto posed =
            plain ? PlainTreeKinematics(parents, rotation, offsets) : TreeKinematics(parents, rotation, offsets);
        const Tensor first = (posed[0] * of_rotation).sum(), second = (posed[1] * of_joints).sum();
        const Tensor loss = part == 0 ? first + second : part == 1 ? first : second;
        results.push_back(torch::autograd::grad({loss}, {rotation, offsets}, {}, false, false, true));
        if (!results.back()[1].defined()) results.back()[1] = torch::zeros_like(offsets);
        results.back().insert(results.back().end(), {posed[0].detach(), posed[1].detach()});
      }
      ExpectAlike(results[0], results[1], 1e-5, "kinematics");
    }
  }
}

/// ConvolveTaps as one product of copied frames.
Tensor PlainConvolveTaps(const Tensor& x, const Tensor& weight, const Tensor& bias) {
  const std::int64_t taps = weight.size(1) / x.size(2), T = x.size(0) - taps + 1;
  std::vector<Tensor> of_tap;
  for (std::int64_t k = 0; k < taps; ++k) of_tap.push_back(x.slice(0, k, k + T));
  return torch::linear(torch::cat(of_tap, 2), weight, bias);
}

TEST(ConvolveTaps, EqualsItsPlainFormWithAllGradients) {
  torch::manual_seed(7);
  const Tensor x = torch::randn({9, 3, 4}, torch::requires_grad());
  const Tensor weight = torch::randn({6, 20}, torch::requires_grad()), bias = torch::randn({6}, torch::requires_grad());
  const Tensor of_result = torch::randn({5, 3, 6});
  std::vector<std::vector<Tensor>> results;
  for (const bool plain : {false, true}) {
    const Tensor result = plain ? PlainConvolveTaps(x, weight, bias) : ConvolveTaps(x, weight, bias);
    results.push_back(torch::autograd::grad({(result * of_result).sum()}, {x, weight, bias}));
    results.back().push_back(result.detach());
  }
  ExpectAlike(results[0], results[1], 1e-5, "convolution");
}

TEST(Attend, EqualsItsPlainFormWithAllGradients) {
  torch::manual_seed(8);
  constexpr std::int64_t T = 6, B = 3, E = 8, H = 2;
  const Draws draws(1, 2, 0, 0);
  for (const bool itself : {true, false}) {
    const std::int64_t S = itself ? T : 4;
    const Tensor queries = torch::randn({T, B, itself ? 3 * E : E}, torch::requires_grad());
    const Tensor memory = itself ? Tensor() : torch::randn({S, B, 2 * E}, torch::requires_grad());
    const Tensor of_result = torch::randn({T, B, E});
    for (const int variant : {0, 1, 2, 3}) {
      AttentionRules rules;
      rules.heads = H;
      rules.causal = itself && variant > 0;
      if (variant > 0) rules.hidden = torch::arange(S).unsqueeze(0) >= torch::tensor({4, 2, 3}).unsqueeze(1);
      if (variant > 1) rules.kept = Dropout(draws, 0.3).Kept(B * H * T * S, rules.scale);
      if (variant > 2) {
        rules.bias = torch::randn({B, S});
        rules.share = torch::rand({B, H, T, S});
      }
      std::vector<Tensor> inputs = {queries};
      if (!itself) inputs.push_back(memory);
      std::vector<std::vector<Tensor>> results;
      for (const bool plain : {false, true}) {
        const AttentionRows rows = {queries, memory};
        const Tensor result = plain ? PlainAttend(rows, rules) : Attend(rows, rules);
        results.push_back(torch::autograd::grad({(result * of_result).sum()}, inputs));
        results.back().push_back(result.detach());
      }
      ExpectAlike(results[0], results[1], 1e-5, "attention");
    }
  }
}

TEST(MatricesOfTwoVectors, EqualTheirPlainFormWithTheGradient) {
  torch::manual_seed(9);
  const Tensor numbers = torch::randn({7, 5, 6}, torch::requires_grad()), of_result = torch::randn({7, 5, 3, 3});
  for (const bool columns : {false, true}) {
    std::vector<std::vector<Tensor>> results;
    for (const bool plain : {false, true}) {
      const Tensor matrices = columns ? plain ? PlainMatricesOfColumns(numbers) : MatricesOfColumns(numbers)
                              : plain ? PlainMatricesOfRows(numbers)
                                      : MatricesOf(numbers, PoseChoice::kRotation6D);
      results.push_back(torch::autograd::grad({(matrices * of_result).sum()}, {numbers}));
      results.back().push_back(matrices.detach());
    }
    ExpectAlike(results[0], results[1], 2e-5, "rotations");
  }
}

TEST(Draws, OfAMotionDoNotDependOnItsNeighboursAndShardsHaveTheirOwn) {
  Draws together({7, 8, 9}), alone({8});
  const Tensor of_three = together.Normal("noise", 5, 3, 4), of_one = alone.Normal("noise", 5, 1, 4);
  EXPECT_TRUE(torch::equal(of_three.select(1, 1), of_one.select(1, 0)));
  Draws first(1, 20, 0, 0), again(1, 20, 0, 0), other_shard(1, 20, 0, 1), other_phase(1, 20, 1, 0);
  const Tensor values = first.Normal("noise", 40, 50, 10);
  EXPECT_TRUE(torch::equal(values, again.Normal("noise", 40, 50, 10)));
  EXPECT_FALSE(torch::equal(values, other_shard.Normal("noise", 40, 50, 10)));
  EXPECT_FALSE(torch::equal(values, other_phase.Normal("noise", 40, 50, 10)));
  EXPECT_NEAR(values.mean().item<double>(), 0.0, 0.03);
  EXPECT_NEAR(values.std().item<double>(), 1.0, 0.03);
  EXPECT_NEAR(values.pow(4).mean().item<double>(), 3.0, 0.3);
  const Tensor uniform = first.Uniform("u", 40, 50, 10);
  EXPECT_GE(uniform.min().item<double>(), 0.0);
  EXPECT_LT(uniform.max().item<double>(), 1.0);
  EXPECT_EQ(first.Coin("coin", 0.5), other_shard.Coin("coin", 0.5)) << "a coin is that of the whole batch";
}

}  // namespace
}  // namespace mocurate
