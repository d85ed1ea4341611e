// ACTOR's loss over shards and padding.

#include <gtest/gtest.h>
#include <torch/torch.h>

#include <cmath>

#include "train/networks/actor.h"

namespace mocurate {
namespace {

constexpr std::int64_t kLossFrames = 8, kLossBatch = 6, kTreeJoints = 3;

std::shared_ptr<Network> ActorOf(ActorCoders coders, bool kl_mean) {
  NetworkOptions options(NetworkKind::kActor);
  options.actor.coders = coders;
  options.actor.latent = 8;
  options.actor.heads = 2;
  options.actor.layers = 1;
  options.actor.feed_forward = 16;
  options.actor.dropout = 0.0;
  options.actor.kl_weight = 0.1;
  options.actor.kl_mean = kl_mean;
  NetworkSizes sizes;
  sizes.joints = kTreeJoints;
  sizes.classes = 2;
  sizes.parents = {-1, 0, 1};
  sizes.rest_offset = {Vector3d::Zero(), Vector3d(0, 1, 0), Vector3d(0, 1, 0)};
  return MakeNetwork(options, sizes);
}

Batch BatchOfLengths(const std::vector<std::int64_t>& lengths) {
  torch::manual_seed(5);
  Batch batch;
  const torch::Tensor length = torch::tensor(lengths).unsqueeze(0);
  batch.valid = torch::arange(kLossFrames).unsqueeze(1) < length;  // (T,B)
  batch.features = torch::randn({kLossFrames, kLossBatch, 6 * (kTreeJoints + 1)}) * batch.valid.unsqueeze(2);
  batch.label = torch::tensor({0, 1, 0, 1, 1, 0}, torch::kInt64);
  batch.whole = kLossBatch;
  batch.whole_frames = length.sum().item<std::int64_t>();
  return batch;
}

TEST(ActorLoss, OfShardsAddsUpToThatOfTheBatch) {
  const Batch whole = BatchOfLengths({8, 5, 6, 8, 3, 7});
  const torch::Tensor latent = torch::randn({1, kLossBatch, 8});
  for (const bool kl_mean : {false, true}) {
    for (const std::int64_t shards : {1, 2, 3}) {
      const auto network = ActorOf(ActorCoders::kTransformer, kl_mean);
      double total = 0.0;
      torch::Tensor gradient;
      for (std::int64_t s = 0; s < shards; ++s) {
        const std::int64_t begin = kLossBatch * s / shards, end = kLossBatch * (s + 1) / shards;
        Batch shard = whole;
        shard.features = whole.features.slice(1, begin, end).contiguous();
        shard.valid = whole.valid.slice(1, begin, end).contiguous();
        shard.label = whole.label.slice(0, begin, end);
        Draws draws(1, 0, 0, static_cast<int>(s));
        draws.Give("latent", latent.slice(1, begin, end));
        const Losses losses = network->Loss(shard, draws, 0);
        total += losses.total.item<double>();
        const torch::Tensor of_shard = torch::autograd::grad({losses.total}, {network->parameters()[3]})[0];
        gradient = gradient.defined() ? gradient + of_shard : of_shard;
      }
      static double want[2] = {0.0, 0.0};
      static torch::Tensor slope[2];
      if (shards == 1) {
        want[kl_mean] = total;
        slope[kl_mean] = gradient;
      }
      EXPECT_NEAR(total, want[kl_mean], 1e-5 * std::fabs(want[kl_mean]));
      EXPECT_LT((gradient - slope[kl_mean]).abs().max().item<double>(), 1e-5);
    }
  }
}

TEST(ActorLoss, OfAMotionDoesNotDependOnItsPadding) {
  for (const ActorCoders coders : {ActorCoders::kTransformer, ActorCoders::kGru, ActorCoders::kAutoregressive}) {
    const auto network = ActorOf(coders, false);
    const Batch padded = BatchOfLengths({8, 5, 6, 8, 3, 7});
    const torch::Tensor latent = torch::randn({1, kLossBatch, 8});
    Draws draws(1, 0, 0, 0);
    draws.Give("latent", latent);
    const auto outputs = network->Loss(padded, draws, 0).outputs;
    Batch alone;
    alone.features = padded.features.slice(0, 0, 3).slice(1, 4, 5).contiguous();
    alone.label = padded.label.slice(0, 4, 5);
    alone.whole = 1;
    Draws own(1, 0, 0, 0);
    own.Give("latent", latent.slice(1, 4, 5));
    const auto short_outputs = network->Loss(alone, own, 0).outputs;
    const torch::Tensor apart = outputs[0].second.slice(0, 0, 3).slice(1, 4, 5) - short_outputs[0].second;
    EXPECT_LT(apart.abs().max().item<double>(), 1e-5) << static_cast<int>(coders);
  }
}

}  // namespace
}  // namespace mocurate
