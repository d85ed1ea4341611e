// ACTOR and its ablations agree with the released networks: outputs, losses, every gradient, weights after AdamW.

#include <cmath>
#include <numeric>

#include "tests/train/network_parity.h"

namespace mocurate {
namespace {

/// (B,J,W,T) of the files -> (T,B,J W).
std::vector<float> FramesOfGolden(const Golden& file, const std::string& path) {
  const auto array = file.Floats(path);
  const auto B = array.shape[0], R = array.shape[1] * array.shape[2], T = array.shape[3];
  std::vector<float> frames(array.values.size());
  for (std::size_t b = 0; b < B; ++b) {
    for (std::size_t r = 0; r < R; ++r) {
      for (std::size_t t = 0; t < T; ++t) frames[(t * B + b) * R + r] = array.values[(b * R + r) * T + t];
    }
  }
  return frames;
}

struct ActorCase {
  std::string group;
  ActorOptions options;
  int rows = 25;  ///< joints and the translation
};

ActorOptions TinyActor() {
  ActorOptions options;
  options.latent = 16;
  options.feed_forward = 32;
  options.layers = 2;
  options.dropout = 0.0;
  options.joint_weight = 0.0;
  return options;
}

TracedNetwork Traced(const Golden& file, const ActorCase& given) {
  TracedNetwork network;
  network.options = NetworkOptions(NetworkKind::kActor);
  network.options.actor = given.options;
  network.options.data.frames = static_cast<std::int64_t>(file.Floats(given.group + "/in/x").shape[3]);
  network.joints = given.options.NeedsRotations() ? given.rows - 1 : given.rows;
  network.parents.assign(static_cast<std::size_t>(network.joints), 0);
  network.parents[0] = -1;
  network.rest_offset.assign(static_cast<std::size_t>(network.joints), Vector3d(0, 1, 0));
  if (network.joints == 24) {
    const auto parents = file.Integers("fake_smpl/parents").values;
    const auto offsets = file.Floats("fake_smpl/offsets").values;
    for (std::size_t j = 0; j < 24; ++j) {
      network.parents[j] = static_cast<int>(parents[j]);
      network.rest_offset[j] = Vector3d(offsets[3 * j], offsets[3 * j + 1], offsets[3 * j + 2]);
    }
  }
  return network;
}

TraceBatch BatchOfGolden(const Golden& file, const std::string& group) {
  TraceBatch batch;
  batch.frames = static_cast<int>(file.Floats(group + "/in/x").shape[3]);
  batch.features = FramesOfGolden(file, group + "/in/x");
  batch.label = GoldenClasses(file, group + "/in/y");
  batch.length = GoldenClasses(file, group + "/in/lengths");
  return batch;
}

void ExpectForward(const Golden& file, const std::string& group, const StepTrace& trace) {
  ExpectNear(trace.outputs, "frames", FramesOfGolden(file, group + "/out/output"), 1e-5, group);
  ExpectNear(trace.outputs, "mean", file.Floats(group + "/out/mu").values, 1e-5, group);
  ExpectNear(trace.outputs, "log_variance", file.Floats(group + "/out/logvar").values, 1e-5, group);
  ExpectNear(trace.outputs, "z", file.Floats(group + "/out/z").values, 1e-5, group);
  const std::pair<const char*, double> terms[] = {
      {"rc", trace.terms.at("pose")}, {"kl", trace.terms.at("kl")}, {"mixed", trace.total}};
  for (const auto& [name, value] : terms) {
    const double want = file.Floats(group + "/loss/" + name).values[0];
    EXPECT_NEAR(value, want, 1e-5 * std::fabs(want)) << group << "/" << name;
  }
}

class ActorTraining : public testing::TestWithParam<std::string> {};

TEST_P(ActorTraining, StepsEqualTheReleasedOnes) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("actor_nets.h5"));
  ActorCase given{GetParam(), TinyActor()};
  if (given.group == "transformer") {
    given.options.joint_weight = 1.0;
    given.options.body_translation = true;
  } else if (given.group == "gru") {
    given.options.coders = ActorCoders::kGru;
    given.rows = 5;
  } else {
    given.options.pose = PoseChoice::kJoints;
    given.options.layers = 1;
    given.rows = 18;
  }
  TracedNetwork network = Traced(file, given);
  std::vector<std::string> names;
  for (const auto& [name, shape] : ShapesOf(network)) names.push_back(name);
  for (const std::string& name : names) {
    network.weights.push_back(GoldenArray(file, given.group + "/init/" + name, name));
  }
  TraceBatch batch = BatchOfGolden(file, given.group);
  const auto later = file.Floats(given.group + "/eps_steps2_3").values;
  batch.draws.push_back({{"latent", {"", {1, 3, 16}, file.Floats(given.group + "/out/eps").values}}});
  for (std::ptrdiff_t step = 0; step < 2; ++step) {
    batch.draws.push_back({{"latent", {"", {1, 3, 16}, {later.begin() + 48 * step, later.begin() + 48 * (step + 1)}}}});
  }
  const auto trace = TraceStep(network, batch);
  ASSERT_TRUE(trace) << trace.error().Message();
  ExpectForward(file, given.group, *trace);
  if (given.group == "transformer") {
    const double want = file.Floats("transformer/loss/rcxyz").values[0];
    EXPECT_NEAR(trace->terms.at("joint"), want, 1e-5 * want);
  }
  const auto mixed = file.Floats(given.group + "/mixed_loss_steps2_3").values;
  for (std::size_t step = 0; step < 2; ++step) {
    EXPECT_NEAR(trace->totals[step + 1], mixed[step], 1e-5 * std::fabs(mixed[step])) << "step " << step + 2;
  }
  for (const std::string& name : names) {
    const std::vector<float> want = file.Floats(given.group + "/grad/" + name).values;
    ExpectNear(trace->gradients, name, want, std::max(1e-8, 1e-5 * LargestValue(want)), given.group + "/grad");
    // Adam makes full steps for gradients at rounding level: those weights are not comparable.
    const std::vector<float> after = file.Floats(given.group + "/after_adamw1/" + name).values;
    const Parameter& ours = trace->after[0][static_cast<std::size_t>(FindParameter(trace->after[0], name))];
    for (std::size_t i = 0; i < after.size(); ++i) {
      EXPECT_NEAR(ours.value[i], after[i], std::fabs(want[i]) > 3e-6 ? 1e-6 : 2e-4) << name << " " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Released, ActorTraining, testing::Values("transformer", "transformer_nolayout_xyz", "gru"),
                         [](const auto& of) { return of.param; });

/// Weights 0.08 sin(0.7 k + 0.3 t); those of norms 1 more.
ParameterList ActorFormulaWeights(const TracedNetwork& network, double amplitude = 0.08, double rate = 0.7) {
  ParameterList weights;
  int t = 0;
  for (const auto& [name, shape] : ShapesOf(network)) {
    Parameter weight{name, shape, {}};
    const std::int64_t count = std::accumulate(shape.begin(), shape.end(), std::int64_t{1}, std::multiplies<>());
    const bool norm = name.find(".norm") != std::string::npos && name.find("weight") != std::string::npos;
    for (std::int64_t k = 0; k < count; ++k) {
      const double value = amplitude * std::sin(rate * static_cast<double>(k) + 0.3 * t);
      weight.value.push_back(static_cast<float>(norm ? 1.0 + value : value));
    }
    weights.push_back(std::move(weight));
    ++t;
  }
  return weights;
}

TEST(ActorGolden, AblationsAndThePapersSizesGiveTheReleasedOutputs) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("actor_nets.h5"));
  std::vector<ActorCase> cases;
  for (const char* group : {"ablation_average_encoder", "ablation_concat_bias", "ablation_zandtime", "formula_fc",
                            "full_transformer", "full_gru"}) {
    cases.push_back({group, TinyActor()});
  }
  cases[0].options.distribution = DistributionChoice::kAverage;
  cases[1].options.condition = ConditionChoice::kConcatenated;
  cases[2].options.condition = ConditionChoice::kOneHot;
  cases[3].options.coders = ActorCoders::kFullyConnected;
  cases[3].rows = 4;
  cases[4].options = ActorOptions();
  cases[4].options.dropout = cases[4].options.joint_weight = 0.0;
  cases[5].options.coders = ActorCoders::kGru;
  cases[5].options.latent = 256;
  cases[5].options.layers = 4;
  const std::int64_t numbers[] = {16838, 16678, 16950, 482016, 14832022, 3439254};
  for (std::size_t i = 0; i < cases.size(); ++i) {
    TracedNetwork network = Traced(file, cases[i]);
    network.weights = ActorFormulaWeights(network);
    EXPECT_EQ(CountValues(network.weights), numbers[i]) << cases[i].group;
    TraceBatch batch = BatchOfGolden(file, cases[i].group);
    const std::int64_t E = cases[i].options.latent;
    batch.draws = {{{"latent", {"", {1, 3, E}, std::vector<float>(static_cast<std::size_t>(3 * E), 0.5f)}}}};
    const auto trace = TraceStep(network, batch);
    ASSERT_TRUE(trace) << trace.error().Message();
    ExpectForward(file, cases[i].group, *trace);
  }
}

TEST(ActorGolden, MotionsOfALatentAreTheReleasedOnes) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("actor_nets.h5"));
  for (const std::string group : {"transformer", "gru"}) {
    ActorCase given{group, TinyActor()};
    if (group == "gru") {
      given.options.coders = ActorCoders::kGru;
      given.rows = 5;
    }
    TracedNetwork network = Traced(file, given);
    for (const auto& [name, shape] : ShapesOf(network)) {
      network.weights.push_back(GoldenArray(file, group + "/init/" + name, name));
    }
    const std::vector<float> z = file.Floats(group + "/generate/z").values;
    const std::vector<int> classes = GoldenClasses(file, group + "/generate/classes");
    const std::vector<int> durations = GoldenClasses(file, group + "/generate/durations");
    const std::vector<float> all = FramesOfGolden(file, group + "/generate/output");
    const std::size_t width = 6 * static_cast<std::size_t>(given.rows);
    for (std::size_t b = 0; b < 3; ++b) {
      const auto parts = TraceParts(
          network,
          {{"z",
            {"",
             {1, 1, 16},
             {z.begin() + 16 * static_cast<std::ptrdiff_t>(b), z.begin() + 16 * static_cast<std::ptrdiff_t>(b + 1)}}},
           {"label", {"", {1}, {static_cast<float>(classes[b])}}},
           {"frames", {"", {1}, {static_cast<float>(durations[b])}}}});
      ASSERT_TRUE(parts) << parts.error().Message();
      std::vector<float> want;
      for (std::size_t t = 0; t < static_cast<std::size_t>(durations[b]); ++t) {
        const auto row = all.begin() + static_cast<std::ptrdiff_t>((t * 3 + b) * width);
        want.insert(want.end(), row, row + static_cast<std::ptrdiff_t>(width));
      }
      ExpectNear(parts->parts, "frames", want, 1e-5, group);
    }
  }
}

/// No numbers of a released autoregressive decoder are at hand: what is fed frame by frame is what training sees at
/// once, and gradients agree with finite differences.
TEST(ActorGolden, TheAutoregressiveDecoderIsConsistent) {
  TracedNetwork network;
  network.options = NetworkOptions(NetworkKind::kActor);
  network.options.actor = TinyActor();
  network.options.actor.coders = ActorCoders::kAutoregressive;
  network.options.actor.kl_weight = 0.1;
  network.joints = 2;
  network.parents = {-1, 0};
  network.rest_offset = {Vector3d::Zero(), Vector3d(0, 1, 0)};
  network.weights = ActorFormulaWeights(network, 0.3, 12.9);  // as good as random
  constexpr int kFrames = 5, kBatch = 2, kWidth = 18;
  std::vector<float> z;
  for (int i = 0; i < 16 * kBatch; ++i) z.push_back(static_cast<float>(std::sin(1.3 * i)));
  const auto made = TraceParts(network, {{"z", {"", {1, kBatch, 16}, z}},
                                         {"label", {"", {kBatch}, {3.0f, 5.0f}}},
                                         {"frames", {"", {1}, {static_cast<float>(kFrames)}}}});
  ASSERT_TRUE(made) << made.error().Message();
  // Fed with its own frames, the decoder gives them again.
  TraceBatch batch;
  batch.frames = kFrames;
  batch.features = made->parts.at("frames").value;
  batch.label = {3, 5};
  batch.draws = {{{"latent", {"", {1, kBatch, 16}, std::vector<float>(16 * kBatch, 0.0f)}}}};
  const auto encoded = TraceStep(network, batch);
  ASSERT_TRUE(encoded) << encoded.error().Message();
  const std::vector<float>& mean = encoded->outputs.at("mean").value;
  const std::vector<float>& log_variance = encoded->outputs.at("log_variance").value;
  for (std::size_t i = 0; i < z.size(); ++i) {
    batch.draws[0]["latent"].value[i] = (z[i] - mean[i]) / std::exp(0.5f * log_variance[i]);
  }
  const auto trace = TraceStep(network, batch);
  ASSERT_TRUE(trace) << trace.error().Message();
  ExpectNear(trace->outputs, "frames", batch.features, 1e-4, "frame by frame");
  EXPECT_EQ(batch.features.size(), static_cast<std::size_t>(kFrames * kBatch * kWidth));

  for (std::size_t i = 0; i < batch.features.size(); ++i) {
    batch.features[i] += static_cast<float>(std::cos(0.7 * static_cast<double>(i)));
  }
  const auto sloped = TraceStep(network, batch);
  ASSERT_TRUE(sloped);
  TracedNetwork moved = network;
  for (const char* name : {"decoder.layers.1.self_attn.in_proj_weight", "decoder.layers.0.linear1.weight",
                           "decoder.output_layer.weight", "decoder.source_embedding.weight"}) {
    const std::vector<float>& gradient = sloped->gradients.at(name).value;
    const auto at = static_cast<std::size_t>(std::max_element(gradient.begin(), gradient.end()) - gradient.begin());
    std::vector<float>& value = moved.weights[static_cast<std::size_t>(FindParameter(moved.weights, name))].value;
    constexpr float kStep = 1e-2f;
    double loss[2] = {0.0, 0.0};
    for (int side = 0; side < 2; ++side) {
      value[at] += side == 0 ? kStep : -2.0f * kStep;
      const auto beside = TraceStep(moved, batch);
      ASSERT_TRUE(beside);
      loss[side] = beside->total;
    }
    value[at] += kStep;
    const double slope = (loss[0] - loss[1]) / (2.0 * kStep);
    EXPECT_NEAR(gradient[at], slope, 2e-2 * std::fabs(slope)) << name;
  }
}

}  // namespace
}  // namespace mocurate
