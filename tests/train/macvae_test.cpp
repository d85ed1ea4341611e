// MACVAE agrees with the released network: positions, priors, posterior, frames, losses, every gradient, a step.

#include <cmath>
#include <numeric>
#include <sstream>

#include "core/base/random.h"
#include "tests/train/gradient_slope.h"
#include "tests/train/network_parity.h"

namespace mocurate {
namespace {

constexpr int kSmplHJoints = 52, kTinyWidth = 16, kStoredFrames = 26;  // frames of the file

MacvaeOptions TinyMacvae() {
  MacvaeOptions options;
  options.width = kTinyWidth;
  options.layers = 2;
  options.feed_forward = 32;
  options.dropout = 0.0;
  options.points = PointChoice::kJoints;
  return options;
}

TracedNetwork MacvaeToTrace(const MacvaeOptions& options, int words = 10) {
  TracedNetwork network;
  network.options = NetworkOptions(NetworkKind::kMacvae);
  network.options.macvae = options;
  network.joints = kSmplHJoints;
  network.words = words;
  for (int j = 0; j < kSmplHJoints; ++j) {
    network.parents.push_back(j - 1);
    network.rest_offset.emplace_back(0.0, 0.1, 0.01 * j);
  }
  return network;
}

/// 0.05 sin(0.7 k + 0.3 t) in the order of the released file, 1 more for norms, the middle tap of the convolution 1.
ParameterList GoldenFormula(const Golden& file, const TracedNetwork& network) {
  std::map<std::string, int> place;
  std::istringstream lines(file.AttributeText("/", "order"));
  int t = 0;
  for (std::string index, name, line; std::getline(lines, line);) {
    std::istringstream(line) >> index >> name;
    place[name] = t++;
  }
  std::vector<std::pair<std::string, std::vector<std::int64_t>>> all = ShapesOf(network);
  for (const char* bn : {"priornet.bn", "encoder.bn"}) {
    const std::int64_t size = bn[0] == 'p' ? 4 * kTinyWidth : kTinyWidth;
    all.push_back({std::string(bn) + ".running_mean", {size}});
    all.push_back({std::string(bn) + ".running_var", {size}});
  }
  ParameterList weights;
  for (const auto& [name, shape] : all) {
    EXPECT_EQ(place.count(name), 1u) << name;
    const auto ends = [&name = name](const std::string& end) {
      return name.size() >= end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
    };
    const bool norm = name.find("norm") != std::string::npos || name.find("bn") != std::string::npos;
    const double one = (norm && ends(".weight")) || ends("running_var") ? 1.0 : 0.0;
    const std::int64_t count = std::accumulate(shape.begin(), shape.end(), std::int64_t{1}, std::multiplies<>());
    Parameter parameter{name, shape, {}};
    for (std::int64_t k = 0; k < count; ++k) {
      parameter.value.push_back(
          static_cast<float>(one + 0.05 * std::sin(0.7 * static_cast<double>(k) + 0.3 * place[name])));
    }
    if (name == "postprocessor.layer.conv1.weight") {
      const auto channels = static_cast<std::size_t>(shape[0]);
      for (std::size_t c = 0; c < channels; ++c) parameter.value[(c * 5 + 2) * channels + c] += 1.0f;
    }
    weights.push_back(std::move(parameter));
  }
  return weights;
}

TracedNetwork GoldenNetwork(const Golden& file) {
  TracedNetwork network = MacvaeToTrace(TinyMacvae());
  const auto parents = file.Integers("fake_smplh/parents").values;
  const auto offsets = file.Floats("fake_smplh/offsets").values;
  for (std::size_t j = 0; j < kSmplHJoints; ++j) {
    network.parents[j] = static_cast<int>(parents[j]);
    network.rest_offset[j] = Vector3d(offsets[3 * j], offsets[3 * j + 1], offsets[3 * j + 2]);
  }
  network.weights = GoldenFormula(file, network);
  return network;
}

TraceBatch GoldenBatch(const Golden& file) {
  const auto pose = file.Floats("in/smpl_param").values, place = file.Floats("in/smpl_trans").values;
  std::vector<float> rows;
  for (std::size_t row = 0; row < 240; ++row) {
    rows.insert(rows.end(), pose.begin() + static_cast<std::ptrdiff_t>(156 * row),
                pose.begin() + static_cast<std::ptrdiff_t>(156 * (row + 1)));
    rows.insert(rows.end(), place.begin() + static_cast<std::ptrdiff_t>(3 * row),
                place.begin() + static_cast<std::ptrdiff_t>(3 * (row + 1)));
  }
  TraceBatch batch;
  batch.frames = 120;
  batch.features = FrameMajor(rows, 2, 120);
  batch.label = {7, 3};
  batch.parts = GoldenClasses(file, "in/frame_length");
  batch.word = GoldenClasses(file, "in/labels");
  return batch;
}

/// (B,K,E) of the files -> (K,B,E) as draws have it.
Parameter LatentDraws(const Golden& file, const std::string& path) {
  return {"", {2, 2, kTinyWidth}, FrameMajor(file.Floats(path).values, 2, 2)};
}

/// The first frames of (T,B,W) as (B,frames,W), columns [begin, end) of W.
std::vector<float> FirstFrames(const Parameter& rows, int frames, std::int64_t begin, std::int64_t end) {
  const std::int64_t B = rows.shape[1];
  std::int64_t W = 1;
  for (std::size_t k = 2; k < rows.shape.size(); ++k) W *= rows.shape[k];
  std::vector<float> result;
  for (std::int64_t b = 0; b < B; ++b) {
    for (std::int64_t t = 0; t < frames; ++t) {
      const auto first = rows.value.begin() + (t * B + b) * W;
      result.insert(result.end(), first + begin, first + end);
    }
  }
  return result;
}

/// Frames [0, length) of each motion of (B,frames,W) alone.
void KeepFrames(const std::vector<int>& length, int frames, std::vector<float>& values) {
  const std::size_t W = values.size() / (length.size() * static_cast<std::size_t>(frames));
  for (std::size_t b = 0; b < length.size(); ++b) {
    for (auto t = static_cast<std::size_t>(length[b]); t < static_cast<std::size_t>(frames); ++t) {
      std::fill_n(values.begin() + static_cast<std::ptrdiff_t>((b * static_cast<std::size_t>(frames) + t) * W), W,
                  0.0f);
    }
  }
}

TEST(Macvae, PositionsAreTheReleasedTables) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("macvae.h5"));
  const auto trace = TraceParts(MacvaeToTrace(TinyMacvae()), {{"transition", {"", {4}, {0, 5, 7, 118}}}});
  ASSERT_TRUE(trace) << trace.error().Message();
  ExpectNear(trace->parts, "encoder_positions", file.Floats("encoder_pe").values, 2e-5, "encoder");
  const auto want = file.Floats("layered_pe/transition_len_0_5_7_118").values;  // (4,120,16)
  ExpectNear(trace->parts, "decoder_positions", FrameMajor(want, 4, 120), 2e-5, "decoder");
}

TEST(Macvae, StepEqualsTheReleasedOne) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("macvae.h5"));
  const TracedNetwork network = GoldenNetwork(file);
  TraceBatch batch = GoldenBatch(file);
  batch.draws = {{{"latent", LatentDraws(file, "train/eps")}}};
  const auto trace = TraceStep(network, batch);
  ASSERT_TRUE(trace) << trace.error().Message();
  const std::pair<const char*, const char*> moments[] = {{"prior_mean", "prior_mean"},
                                                         {"prior_log_variance", "prior_logvar"},
                                                         {"posterior_mean", "posterior_mean"},
                                                         {"posterior_log_variance", "posterior_logvar"},
                                                         {"z", "z"}};
  for (const auto& [ours, theirs] : moments) {
    ExpectNear(trace->outputs, ours, file.Floats(std::string("train/") + theirs).values, 1e-5, "train");
  }
  const std::vector<int> length = {22, 25};
  const auto expect = [&](const char* ours, std::int64_t begin, std::int64_t end, const char* theirs, int frames,
                          double tolerance, const std::vector<int>& kept) {
    std::vector<float> got = FirstFrames(trace->outputs.at(ours), frames, begin, end);
    std::vector<float> want = file.Floats(std::string("train/") + theirs).values;
    if (frames < kStoredFrames) {
      std::vector<float> part;
      for (int b = 0; b < 2; ++b) {
        const auto width = static_cast<std::ptrdiff_t>(want.size() / (2 * kStoredFrames));
        part.insert(part.end(), want.begin() + b * kStoredFrames * width,
                    want.begin() + (b * kStoredFrames + frames) * width);
      }
      want = part;
    }
    KeepFrames(kept, frames, got);
    KeepFrames(kept, frames, want);
    EXPECT_LE(WorstDifference(got, want), tolerance) << theirs;
  };
  expect("decoded", 0, 312, "decoder_6d", 25, 1e-5, {25, 25});
  expect("decoded", 312, 315, "decoder_trans", 25, 1e-5, {25, 25});
  expect("smoothed", 0, 312, "post_6d", kStoredFrames, 1e-5, {26, 26});
  expect("smoothed", 312, 315, "post_trans", kStoredFrames, 1e-5, {26, 26});
  expect("pose", 0, 156, "gen_smpl_param", kStoredFrames, 5e-4, {26, 26});
  std::vector<float> joints = FirstFrames(trace->outputs.at("joints"), kStoredFrames, 0, 156);
  const auto offset = file.Floats("fake_smplh/offsets").values;
  for (std::size_t i = 0; i < joints.size(); ++i) joints[i] += offset[i % 3];  // the file's root has an offset
  std::vector<float> want = file.Floats("train/gen_smpl_joint").values;
  KeepFrames(length, kStoredFrames, joints);
  KeepFrames(length, kStoredFrames, want);
  EXPECT_LE(WorstDifference(joints, want), 1e-4);

  const std::pair<const char*, const char*> terms[] = {
      {"pose", "rec_pose"}, {"point", "rec_mesh"}, {"acceleration", "accel_loss"}};
  for (const auto& [ours, theirs] : terms) {
    const double value = file.Floats(std::string("train/loss_mean/") + theirs).values[0];
    EXPECT_NEAR(trace->terms.at(ours), value, 1e-5 * value) << ours;
  }
  const double kl = file.Floats("train/loss_mean/kl_loss").values[0];
  EXPECT_NEAR(1e-5 * trace->terms.at("kl"), kl, 1e-5 * kl);
  const double total = file.Floats("train/total").values[0];
  EXPECT_NEAR(trace->total, total, 1e-5 * total);

  for (const auto& [name, shape] : ShapesOf(network)) {
    if (name.rfind("priornet.bn", 0) == 0) {
      EXPECT_EQ(trace->gradients.count(name), 0u) << name << " is read by nothing";
      continue;
    }
    // torch 1.13's conv2d gives wrong gradients of weights of one input channel at this width (16 numbers a frame), in
    // the file too: GradientsAreSlopes looks at them.
    const bool wrong = name == "encoder.mean_conv.weight" || name == "encoder.logvar_conv.weight" ||
                       name == "decoder.post_conv.weight";
    const double norm = file.Floats("train/grad_norm/" + name).values[0];
    if (wrong || norm < 1e-8) continue;  // biases before a normalisation: their true gradient is 0
    const std::vector<float>& got = trace->gradients.at(name).value;
    double square = 0.0;
    for (const float value : got) square += static_cast<double>(value) * value;
    EXPECT_NEAR(std::sqrt(square), norm, 3e-4 * norm) << name;
    const auto stored = file.Floats("train/grad/" + name).values;  // every 97th of the large ones
    const std::size_t stride = got.size() > 6000 ? 97 : 1;
    for (std::size_t i = 0; i < stored.size(); ++i) {
      EXPECT_NEAR(got[i * stride], stored[i], 3e-4 * norm) << name << " " << i * stride;
    }
  }
  for (const char* name : {"encoder.bn.running_mean", "encoder.bn.running_var"}) {
    const int at = FindParameter(trace->after[0], name);
    ASSERT_GE(at, 0);
    EXPECT_LE(WorstDifference(trace->after[0][static_cast<std::size_t>(at)].value,
                              file.Floats(std::string("train/after_running/") + name).values),
              1e-5);
  }
}

/// A variant of a table, or of the paper's text.
struct MacvaeVariant {
  const char* name;
  void (*change)(MacvaeOptions&);
  std::int64_t parameters;  ///< of the network of width 16, J = 4, 12 frames, 6 words
};

class MacvaeVariants : public testing::TestWithParam<MacvaeVariant> {};

/// Three motions of 12 frames of a chain of four joints.
TraceBatch SmallBatch(std::int64_t latents) {
  TraceBatch batch;
  batch.frames = 12;
  Random random(3, "macvae");
  for (int row = 0; row < 36; ++row) {
    for (int k = 0; k < 15; ++k) batch.features.push_back(static_cast<float>(random.Uniform(-0.8, 0.8)));
  }
  batch.label = {0, 1, 2};
  batch.parts = {5, 2, 4, 4, 3, 5, 6, 3, 2};
  batch.word = {0, 3, 1, 4, 3, 2, 5, 3, 0};
  Parameter noise{"", {latents, 3, 16}, {}};
  for (std::int64_t k = 0; k < latents * 48; ++k) noise.value.push_back(static_cast<float>(random.Normal()));
  batch.draws = {{{"latent", noise}}};
  return batch;
}

TracedNetwork SmallMacvae(const MacvaeVariant& variant) {
  MacvaeOptions options = TinyMacvae();
  options.points = PointChoice::kMarkers;
  options.previous_frames = 3;
  variant.change(options);
  TracedNetwork network = MacvaeToTrace(options, 6);
  network.options.data.frames = 12;
  network.joints = 4;
  network.parents.resize(4);
  network.rest_offset.resize(4);
  return network;
}

TEST_P(MacvaeVariants, LossRisesAlongItsGradientAsTheGradientSays) {
  TracedNetwork network = SmallMacvae(GetParam());
  network.options.macvae.kl_weight = 0.01;
  // Rotation vectors jump where an angle passes a half turn; the released file is the reference of their gradients.
  if (network.options.macvae.released()) network.options.macvae.pose_weight = 0.0;
  const TraceBatch batch = SmallBatch(network.options.macvae.separate_latents ? 2 : 1);
  const auto trace = TraceStep(network, batch);
  ASSERT_TRUE(trace) << trace.error().Message();
  for (const std::string part : {"encoder.", "decoder.", "priornet.", "postprocessor."}) {
    if (part == "postprocessor." && !network.options.macvae.postprocessor) {
      EXPECT_EQ(GradientNorm(*trace, part), 0.0);
      continue;
    }
    ExpectSlopeOfGradient(network, batch, *trace, part);
  }
}

TEST_P(MacvaeVariants, HasTheStatedNumberOfParameters) {
  std::int64_t count = 0;
  for (const auto& [name, shape] : ShapesOf(SmallMacvae(GetParam()))) {
    count += std::accumulate(shape.begin(), shape.end(), std::int64_t{1}, std::multiplies<>());
  }
  EXPECT_EQ(count, GetParam().parameters);
}

INSTANTIATE_TEST_SUITE_P(
    Tables, MacvaeVariants,
    testing::Values(MacvaeVariant{"Released", [](MacvaeOptions&) {}, 22627},
                    MacvaeVariant{"Paper", [](MacvaeOptions& o) { o.protocol = Protocol::kPaper; }, 22691},
                    MacvaeVariant{"OneLatent", [](MacvaeOptions& o) { o.separate_latents = false; }, 22627},
                    MacvaeVariant{"ActionToPrevious", [](MacvaeOptions& o) { o.action_to_previous = true; }, 22627},
                    MacvaeVariant{"WholePrevious", [](MacvaeOptions& o) { o.whole_previous = true; }, 24547},
                    MacvaeVariant{"Lstm", [](MacvaeOptions& o) { o.backbone = MacvaeBackbone::kLstm; }, 20659},
                    MacvaeVariant{"Gru", [](MacvaeOptions& o) { o.backbone = MacvaeBackbone::kGru; }, 18483},
                    MacvaeVariant{"Mlp", [](MacvaeOptions& o) { o.backbone = MacvaeBackbone::kMlp; }, 13043},
                    MacvaeVariant{"NoPostprocessor", [](MacvaeOptions& o) { o.postprocessor = false; }, 18955},
                    MacvaeVariant{"LastFills", [](MacvaeOptions& o) { o.fill = FillChoice::kLast; }, 22627}),
    [](const auto& of) { return of.param.name; });

TEST(Macvae, FullSizeHasThePublishedNumberOfParameters) {
  const TracedNetwork network = MacvaeToTrace(MacvaeOptions(), 5396);
  std::map<std::string, std::int64_t> of_part;
  for (const auto& [name, shape] : ShapesOf(network)) {
    of_part[name.substr(0, name.find('.'))] +=
        std::accumulate(shape.begin(), shape.end(), std::int64_t{1}, std::multiplies<>());
  }
  EXPECT_EQ(of_part["encoder"], 31475712);  // multiact.md C.1
  EXPECT_EQ(of_part["decoder"], 34439995);
  EXPECT_EQ(of_part["priornet"], 6181888);
  EXPECT_EQ(of_part["postprocessor"], 496440);
}

}  // namespace
}  // namespace mocurate
