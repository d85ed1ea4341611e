// ST-GCN agrees with the released network: features, logits, training loss, gradients, running statistics.

#include <cmath>
#include <filesystem>
#include <numeric>

#include "tests/support/scratch_folder.h"
#include "tests/train/network_parity.h"
#include "tests/train/recogniser_runs.h"
#include "train/checkpoint/checkpoint.h"

namespace mocurate {
namespace {

TracedNetwork TracedStGcn(bool global) {
  TracedNetwork network;
  network.options = NetworkOptions(NetworkKind::kStGcn);
  network.options.st_gcn.global_orientation = global;
  network.classes = 40;
  network.joints = 24;
  network.parents = {-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19, 20, 21};
  network.rest_offset.assign(24, Vector3d(0, 1, 0));
  return network;
}

/// a = amp sin(0.7 k + 0.3 t), t in the order of the file; weights of norms, variances and edges hold 1 + a.
ParameterList FormulaOf(const std::vector<std::pair<std::string, std::vector<std::int64_t>>>& order) {
  ParameterList weights;
  for (std::size_t t = 0; t < order.size(); ++t) {
    const auto& [name, shape] = order[t];
    Parameter weight{name, shape, {}};
    const std::int64_t count = std::accumulate(shape.begin(), shape.end(), std::int64_t{1}, std::multiplies<>());
    const bool one = name.find("running_var") != std::string::npos || name.rfind("edge_importance", 0) == 0 ||
                     (shape.size() == 1 && name.find("weight") != std::string::npos);
    const double amplitude = shape.size() == 4 ? 0.05 : 0.08;
    for (std::int64_t k = 0; k < count; ++k) {
      const double value = amplitude * std::sin(0.7 * static_cast<double>(k) + 0.3 * static_cast<double>(t));
      weight.value.push_back(static_cast<float>(one ? 1.0 + value : value));
    }
    weights.push_back(std::move(weight));
  }
  return weights;
}

/// Names and shapes in the order of PyTorch's state_dict: of each layer its parameters, then its running statistics.
std::vector<std::pair<std::string, std::vector<std::int64_t>>> StateOrder(const TracedNetwork& network) {
  const auto shapes = ShapesOf(network);
  std::vector<std::pair<std::string, std::vector<std::int64_t>>> order;
  for (const auto& [name, shape] : shapes) {
    order.emplace_back(name, shape);
    const bool norm = shape.size() == 1 && name.size() > 5 && name.substr(name.size() - 5) == ".bias" &&
                      order[order.size() - 2].second.size() == 1;
    if (!norm) continue;
    const std::string layer = name.substr(0, name.size() - 4);
    order.emplace_back(layer + "running_mean", shape);
    order.emplace_back(layer + "running_var", shape);
  }
  return order;
}

class StGcnGolden : public testing::TestWithParam<bool> {};

TEST_P(StGcnGolden, FeaturesLossAndGradientsAreTheReleasedOnes) {
  MOCURATE_NEEDS_GOLDENS();
  const Golden file(golden::PathOf("stgcn.h5"));
  const std::string group = GetParam() ? "smpl" : "smpl_noglobal";
  TracedNetwork network = TracedStGcn(GetParam());
  network.weights = FormulaOf(StateOrder(network));
  const auto x = file.Floats(group + "/x");
  const std::size_t B = x.shape[0], R = x.shape[1] * x.shape[2], T = x.shape[3];
  std::vector<float> frames(x.values.size());
  for (std::size_t b = 0; b < B; ++b) {
    for (std::size_t r = 0; r < R; ++r) {
      for (std::size_t t = 0; t < T; ++t) frames[(t * B + b) * R + r] = x.values[(b * R + r) * T + t];
    }
  }
  const std::vector<std::int64_t> shape = {static_cast<std::int64_t>(T), static_cast<std::int64_t>(B),
                                           static_cast<std::int64_t>(R)};
  const auto parts = TraceParts(network, {{"rotation_6d", {"", shape, frames}}});
  ASSERT_TRUE(parts) << parts.error().Message();
  ExpectNear(parts->parts, "features", file.Floats(group + "/eval/features").values, 5e-6, group);
  ExpectNear(parts->parts, "logits", file.Floats(group + "/eval/yhat").values, 5e-6, group);

  // What scoring runs, from a checkpoint.
  Checkpoint checkpoint;
  checkpoint.kind = kStGcnKind;
  checkpoint.options = OptionsToJson(network.options);
  for (int c = 0; c < network.classes; ++c) checkpoint.labels.push_back("class" + std::to_string(c));
  auto skeleton = std::make_shared<Skeleton>();
  for (int j = 0; j < 24; ++j) {
    Joint joint;
    joint.name = "j" + std::to_string(j);
    joint.parent = network.parents[static_cast<std::size_t>(j)];
    joint.mirror = j;
    joint.rest_offset = Vector3d(0, j > 0 ? 0.1 : 0.0, 0);
    skeleton->joints.push_back(joint);
  }
  skeleton->name = "tree";
  checkpoint.skeleton = skeleton;
  checkpoint.parameters = network.weights;
  const ScratchFolder folder;
  const auto path = folder / (group + ".h5");
  ASSERT_TRUE(WriteCheckpoint(checkpoint, path));
  const auto recogniser = Recogniser::Load(path);
  ASSERT_TRUE(recogniser) << recogniser.error().Message();
  EXPECT_TRUE((*recogniser)->reads_rotations());
  std::vector<float> motions(frames.size());  // (B,T,6V)
  for (std::size_t b = 0; b < B; ++b) {
    for (std::size_t t = 0; t < T; ++t) {
      std::copy_n(frames.begin() + static_cast<std::ptrdiff_t>((t * B + b) * R), R,
                  motions.begin() + static_cast<std::ptrdiff_t>((b * T + t) * R));
    }
  }
  const auto output =
      RunOn(**recogniser, motions, static_cast<int>(B), static_cast<int>(T), static_cast<int>(R), {}, {}, 2);
  ASSERT_TRUE(output) << output.error().Message();
  EXPECT_LE(WorstDifference(output->features, file.Floats(group + "/eval/features").values), 5e-6);
  EXPECT_LE(WorstDifference(output->logits, file.Floats(group + "/eval/yhat").values), 5e-6);

  TraceBatch batch;
  batch.frames = static_cast<int>(T);
  batch.features = frames;
  batch.label = GoldenClasses(file, group + "/y");
  batch.draws = {{}};
  const auto trace = TraceStep(network, batch);
  ASSERT_TRUE(trace) << trace.error().Message();
  EXPECT_NEAR(trace->total, file.Floats(group + "/train/cross_entropy").values[0], 1e-5);
  for (const auto& [name, gradient] : trace->gradients) {
    const double want = file.Floats(group + "/train/grad_norm/" + name).values[0];
    double norm = 0.0;
    for (const float value : gradient.value) norm += static_cast<double>(value) * value;
    EXPECT_NEAR(std::sqrt(norm), want, std::max(1e-2 * want, 1e-6)) << name;
    if (group != "smpl") continue;  // the file holds their first numbers
    const std::vector<float> head = file.Floats(group + "/train/grad_head/" + name).values;
    for (std::size_t k = 0; k < head.size(); ++k) {
      EXPECT_NEAR(gradient.value[k], head[k], std::max(1e-2 * want, 1e-6)) << name << " " << k;
    }
  }
  for (const char* name : {"data_bn.running_mean", "data_bn.running_var", "st_gcn_networks.0.tcn.0.running_mean",
                           "st_gcn_networks.9.tcn.3.running_var"}) {
    const Parameter& ours = trace->after[0][static_cast<std::size_t>(FindParameter(trace->after[0], name))];
    EXPECT_LE(WorstDifference(ours.value, file.Floats(group + "/train/after_running/" + name).values), 1e-5) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Released, StGcnGolden, testing::Bool(),
                         [](const auto& of) { return of.param ? "global" : "local"; });

}  // namespace
}  // namespace mocurate
