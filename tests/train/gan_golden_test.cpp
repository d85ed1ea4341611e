// The networks of Act-MoCoGAN agree with the released ones: outputs and gradients of generators and discriminators.

#include "tests/train/network_parity.h"

namespace mocurate {
namespace {

using Names = std::vector<std::pair<std::string, std::string>>;

Names GruNames(const std::string& part, const std::string& gru, int layers) {
  Names names;
  for (int l = 0; l < layers; ++l) {
    for (const char* value : {"weight_ih_l", "weight_hh_l", "bias_ih_l", "bias_hh_l"}) {
      const std::string name = gru + "." + value + std::to_string(l);
      names.emplace_back(part + "." + name, name);
    }
  }
  return names;
}

void AddLinear(const std::string& part, const std::string& layer, Names& names) {
  for (const char* value : {".weight", ".bias"}) names.emplace_back(part + "." + layer + value, layer + value);
}

TracedNetwork TinyGan(bool lie, int classes) {
  TracedNetwork network;
  network.options = NetworkOptions(NetworkKind::kActMoCoGan);
  network.options.act_mocogan.lie = lie;
  network.options.act_mocogan.hidden = 16;
  network.options.act_mocogan.latent = 6;
  network.classes = classes;
  network.chains = HumanAct12Chains();
  return network;
}

class MoCoGanGolden : public testing::TestWithParam<std::string> {};

TEST_P(MoCoGanGolden, TheGeneratorEqualsTheReleasedOne) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("a2m_gan.h5"));
  const std::string group = GetParam();
  const bool lie = group == "generator_lie";
  TracedNetwork network = TinyGan(lie, 12);
  Names names = GruNames("generator", "recurrent_z", 1);
  for (const auto& name : GruNames("generator", "recurrent_h", 2)) names.push_back(name);
  for (const char* layer : {"linear_lie", "linear_traj"}) {
    if (lie) AddLinear("generator", layer, names);
  }
  if (!lie) AddLinear("generator", "linear", names);
  network.weights = GoldenWeights(file, group + "/params", names);
  for (const std::string& branch : {group, group + "/fixed"}) {
    TraceValues inputs;
    inputs["z"] = GoldenArray(file, branch + (branch == group ? "/z_noise" : "/z_m"), "z");
    inputs["h0_z"] = GoldenArray(file, branch + "/h0_z", "h0_z");
    inputs["h0_h"] = GoldenArray(file, branch + "/h0_h", "h0_h");
    inputs["classes"] = {"classes", {3}, {}};
    for (const int label : GoldenClasses(file, branch + "/classes")) {
      inputs["classes"].value.push_back(static_cast<float>(label));
    }
    TraceValues cotangents;
    if (branch == group) cotangents["generator"] = GoldenArray(file, group + "/cotangent", "cotangent");
    const auto trace = TraceParts(network, inputs, cotangents);
    ASSERT_TRUE(trace) << trace.error().Message();
    ExpectNear(trace->parts, "generator", file.Floats(branch + "/output").values, 5e-6, branch);
    for (const auto& [name, stored] : names) {
      if (branch != group) break;
      const std::vector<float> want = file.Floats(group + "/grad/" + stored).values;
      ExpectNear(trace->gradients, name, want, 1e-5 * LargestValue(want), group + "/grad");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Generators, MoCoGanGolden, testing::Values("generator", "generator_lie"));

TEST(MoCoGanGolden, TheMotionDiscriminatorEqualsTheReleasedOne) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("a2m_gan.h5"));
  // The released file has one without the real/fake column, and one with it.
  for (const std::string group : {"discriminator", "categorical_discriminator"}) {
    const bool categorical = group == "categorical_discriminator";
    TracedNetwork network = TinyGan(false, categorical ? 12 : 11);
    Names names = GruNames("motion_discriminator", "recurrent", 2);
    AddLinear("motion_discriminator", "linear1", names);
    AddLinear("motion_discriminator", "linear2", names);
    network.weights = GoldenWeights(file, group + "/params", names);
    TraceValues inputs;
    inputs["h0"] = GoldenArray(file, group + "/h0", "h0");
    inputs["motion"] = GoldenArray(file, "motion", "motion");
    inputs["motion"].value = FrameMajor(inputs["motion"].value, 3, static_cast<int>(inputs["motion"].shape[1]));
    std::swap(inputs["motion"].shape[0], inputs["motion"].shape[1]);
    TraceValues cotangents;
    if (!categorical) {  // the gradient of the sum of squares
      cotangents["discriminator"] = GoldenArray(file, group + "/output", "output");
      for (float& value : cotangents["discriminator"].value) value *= 2.0f;
    }
    const auto trace = TraceParts(network, inputs, cotangents);
    ASSERT_TRUE(trace) << trace.error().Message();
    if (!categorical) {
      ExpectNear(trace->parts, "discriminator", file.Floats(group + "/output").values, 5e-6, group);
      for (const auto& [name, stored] : names) {
        const std::vector<float> want = file.Floats(group + "/grad_of_sum_squares/" + stored).values;
        ExpectNear(trace->gradients, name, want, 1e-5 * LargestValue(want), group);
      }
      continue;
    }
    const auto real = file.Floats(group + "/real_fake"), category = file.Floats(group + "/category");
    const std::vector<float>& got = trace->parts.at("discriminator").value;
    for (std::size_t b = 0; b < 3; ++b) {
      EXPECT_NEAR(got[b * 13], real.values[b], 5e-6);
      for (std::size_t c = 0; c < 12; ++c) EXPECT_NEAR(got[b * 13 + 1 + c], category.values[b * 12 + c], 5e-6);
    }
  }
}

}  // namespace
}  // namespace mocurate
