#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "tests/support/golden.h"
#include "tests/train/chains.h"
#include "train/checkpoint/adam.h"
#include "train/networks/action2motion.h"

namespace mocurate {
namespace {

constexpr double kTolerance = 5e-6;

void ExpectNear(const std::vector<float>& got, const std::vector<float>& want, double tolerance,
                const std::string& what) {
  ASSERT_EQ(got.size(), want.size()) << what;
  double worst = 0.0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    const double difference = std::fabs(static_cast<double>(got[i]) - want[i]);
    worst = difference <= worst ? worst : difference;  // a NaN stays
  }
  EXPECT_LE(worst, tolerance) << what;
}

double Largest(const std::vector<float>& values) {
  double largest = 1e-30;
  for (const float value : values) largest = std::max(largest, std::fabs(static_cast<double>(value)));
  return largest;
}

Action2MotionConfig TinyConfig(const std::string& group) {
  Action2MotionConfig config;
  config.hidden = 16;
  config.latent = 6;
  config.time_counter = group == "plain" ? TimeCounter::kNone : TimeCounter::kReleased;
  config.kl_weight = group == "lie" ? 1e-3 : 1e-4;
  if (group == "lie") config.lie = HumanAct12Chains();
  return config;
}

ParameterList Initial(const Golden& file, const std::string& group, const Action2MotionConfig& config) {
  ParameterList parameters = Action2MotionParameters(config);
  for (Parameter& parameter : parameters) parameter.value = file.Floats(group + "/init/" + parameter.name).values;
  return parameters;
}

// (B,T,D) -> (T,B,D)
std::vector<float> FrameMajor(const std::vector<float>& values, int batch, int frames, int width) {
  std::vector<float> result(values.size());
  for (int b = 0; b < batch; ++b) {
    for (int t = 0; t < frames; ++t) {
      for (int k = 0; k < width; ++k) {
        result[(static_cast<std::size_t>(t) * batch + b) * width + k] =
            values[(static_cast<std::size_t>(b) * frames + t) * width + k];
      }
    }
  }
  return result;
}

Action2MotionBatch GoldenBatch(const Golden& file, bool self_feed) {
  Action2MotionBatch batch;
  batch.batch = 3;
  batch.frames = 5;
  batch.motion = FrameMajor(file.Floats("data").values, 3, 5, 72);
  for (const std::int64_t label : file.Integers("classes").values) batch.label.push_back(static_cast<int>(label));
  batch.self_feed = self_feed;
  return batch;
}

class Action2MotionGolden : public testing::TestWithParam<std::string> {};

TEST_P(Action2MotionGolden, ATrainingStepEqualsTheReleasedOne) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("a2m_nets.h5"));
  const std::string group = GetParam();
  const Action2MotionConfig config = TinyConfig(group);
  for (const bool self_feed : {false, true}) {
    const std::string branch = group + (self_feed ? "/train_own_prediction" : "/train_ground_truth");
    ParameterList parameters = Initial(file, group, config);
    Action2MotionBatch batch = GoldenBatch(file, self_feed);
    batch.noise = file.Floats(branch + "/eps_posterior").values;
    Action2MotionTrace trace;
    const Action2MotionLoss loss = Action2MotionStep(config, batch, parameters, &trace);
    EXPECT_NEAR(loss.total, file.Doubles(branch + "/loss_sum")[0], kTolerance * std::fabs(loss.total)) << branch;
    EXPECT_NEAR(loss.reconstruction, file.Doubles(branch + "/recon_sum")[0], kTolerance * loss.reconstruction)
        << branch;
    EXPECT_NEAR(loss.kl, file.Doubles(branch + "/kld_sum")[0], kTolerance * loss.kl) << branch;
    const auto recon = file.Doubles(branch + "/recon_per_step"), kl = file.Doubles(branch + "/kld_per_step");
    for (int t = 0; t < 5; ++t) {
      EXPECT_NEAR(trace.reconstruction[t], recon[t], kTolerance) << branch << " " << t;
      EXPECT_NEAR(trace.kl[t], kl[t], kTolerance * std::fabs(kl[t]) + 1e-6) << branch << " " << t;
    }
    ExpectNear(trace.output, file.Floats(branch + "/x_pred").values, kTolerance, branch + "/x_pred");
    ExpectNear(trace.z, file.Floats(branch + "/z_q").values, kTolerance, branch + "/z_q");
    ExpectNear(trace.mean, file.Floats(branch + "/mu_q").values, kTolerance, branch + "/mu_q");
    ExpectNear(trace.log_variance, file.Floats(branch + "/logvar_q").values, kTolerance, branch + "/logvar_q");
    ExpectNear(trace.prior_mean, file.Floats(branch + "/mu_p").values, kTolerance, branch + "/mu_p");
    ExpectNear(trace.prior_log_variance, file.Floats(branch + "/logvar_p").values, kTolerance, branch + "/logvar_p");
    if (config.lie)
      ExpectNear(trace.joints, file.Floats(branch + "/joints_pred").values, kTolerance, branch + "/joints");
    for (const Parameter& parameter : parameters) {
      const std::vector<float> want = file.Floats(branch + "/grad/" + parameter.name).values;
      ExpectNear(parameter.gradient, want, 1e-5 * Largest(want), branch + "/grad/" + parameter.name);
    }
  }
}

TEST_P(Action2MotionGolden, WeightsAfterOneAndThreeAdamStepsEqualTheReleasedOnes) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("a2m_nets.h5"));
  const std::string group = GetParam();
  const Action2MotionConfig config = TinyConfig(group);
  for (const bool self_feed : {false, true}) {
    const std::string branch = group + (self_feed ? "/train_own_prediction" : "/train_ground_truth");
    ParameterList parameters = Initial(file, group, config);
    Action2MotionBatch batch = GoldenBatch(file, self_feed);
    std::vector<float> noise = file.Floats(branch + "/eps_posterior").values;
    const std::vector<float> later = file.Floats(branch + "/step2_3_eps_posterior").values;
    noise.insert(noise.end(), later.begin(), later.end());
    Adam adam;
    AdamOptions options;
    options.learning_rate = 2e-4;
    options.weight_decay = 1e-5;
    const auto size = static_cast<std::ptrdiff_t>(noise.size() / 3);
    for (int step = 1; step <= 3; ++step) {
      batch.noise.assign(noise.begin() + (step - 1) * size, noise.begin() + step * size);
      Action2MotionStep(config, batch, parameters);
      adam.Step(options, parameters);
      if (step == 2) continue;
      for (const Parameter& parameter : parameters) {
        const std::string name = branch + "/after_adam" + std::to_string(step) + "/" + parameter.name;
        ExpectNear(parameter.value, file.Floats(name).values, kTolerance, name);
      }
    }
  }
}

TEST_P(Action2MotionGolden, GeneratedMotionsEqualTheReleasedOnes) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("a2m_nets.h5"));
  const std::string group = GetParam();
  const Action2MotionConfig config = TinyConfig(group);
  const ParameterList parameters = Initial(file, group, config);
  std::vector<int> label;
  for (const double c : file.AttributeDoubles(group + "/generate", "classes")) label.push_back(static_cast<int>(c));
  const std::vector<float> output =
      Action2MotionGenerate(config, parameters, label, 5, file.Floats(group + "/generate/eps").values, {});
  ExpectNear(output, FrameMajor(file.Floats(group + "/generate/output").values, 3, 5, 72), kTolerance, group);
  if (!config.lie) return;
  const LieLayer layer(*config.lie, config.exp);
  const std::vector<float> data = FrameMajor(file.Floats("data").values, 3, 5, 72);
  std::vector<float> length(3 * 24), joints(3 * 72), all;
  layer.BoneLengths(data.data(), 3, length.data());
  for (int t = 0; t < 5; ++t) {
    layer.Forward(output.data() + t * 3 * 72, length.data(), 3, joints.data());
    all.insert(all.end(), joints.begin(), joints.end());
  }
  ExpectNear(all, FrameMajor(file.Floats("lie/generate/joints").values, 3, 5, 72), kTolerance, "joints");
}

INSTANTIATE_TEST_SUITE_P(Networks, Action2MotionGolden, testing::Values("plain", "plain_time", "lie"));

/// Weights by formula: tensor t of a module, number k: 0.08 sin(0.7 k + 0.3 t).
ParameterList FormulaParameters(const Action2MotionConfig& config) {
  ParameterList parameters = Action2MotionParameters(config);
  std::map<std::string, int> tensors;
  for (Parameter& parameter : parameters) {
    const int t = tensors[parameter.name.substr(0, parameter.name.find('/'))]++;
    for (std::size_t k = 0; k < parameter.value.size(); ++k) {
      parameter.value[k] = static_cast<float>(0.08 * std::sin(0.7 * static_cast<double>(k) + 0.3 * t));
    }
  }
  return parameters;
}

/// Three calls on the same rows. (The file's note says that the rows grow from call to call; its numbers say that they
/// do not: with rows that grow, every call but the first is off by 1e-3.)
std::vector<float> ThreeCalls(const std::vector<float>& rows) {
  std::vector<float> calls;
  for (int s = 0; s < 3; ++s) calls.insert(calls.end(), rows.begin(), rows.end());
  return calls;
}

TEST(Action2MotionGolden, NetworksOfThePapersSizeEqualTheReleasedOnes) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("a2m_nets.h5"));
  for (const std::string group : {"full_plain", "full_lie"}) {
    Action2MotionConfig config;
    if (group == "full_lie") config.lie = HumanAct12Chains();
    const ParameterList parameters = FormulaParameters(config);
    Action2MotionRows rows{4, 3, {}, {}};
    rows.prior = ThreeCalls(file.Floats(group + "/prior_input").values);
    rows.decoder = ThreeCalls(file.Floats(group + "/decoder_input").values);
    const Action2MotionAnswers answers = Action2MotionForward(config, parameters, rows);
    const auto part = [](const std::vector<float>& all, int s) {
      const auto size = static_cast<std::ptrdiff_t>(all.size() / 3);
      return std::vector<float>(all.begin() + s * size, all.begin() + (s + 1) * size);
    };
    for (int s = 0; s < 3; ++s) {
      const std::string step = group + "/step" + std::to_string(s);
      ExpectNear(part(answers.hidden, s), file.Floats(step + "/h").values, kTolerance, step + "/h");
      ExpectNear(part(answers.mean, s), file.Floats(step + "/mu").values, kTolerance, step + "/mu");
      ExpectNear(part(answers.log_variance, s), file.Floats(step + "/logvar").values, kTolerance, step + "/logvar");
      ExpectNear(part(answers.output, s), file.Floats(step + "/decoder_out").values, kTolerance, step + "/decoder_out");
    }
  }
}

TEST(Action2MotionGolden, KlEqualsTheReleasedOne) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("a2m_nets.h5"));
  const double kl = GaussianKl(file.Floats("kl/mu1").values, file.Floats("kl/logvar1").values,
                               file.Floats("kl/mu2").values, file.Floats("kl/logvar2").values, 3);
  EXPECT_NEAR(kl, file.Doubles("kl/value")[0], 1e-5 * std::fabs(kl));
}

TEST(Action2MotionGolden, NetworksOfThePaperHaveItsNumberOfParameters) {
  Action2MotionConfig config;
  config.lie = HumanAct12Chains();
  EXPECT_EQ(CountValues(Action2MotionParameters(config)), 462750);
}

}  // namespace
}  // namespace mocurate
