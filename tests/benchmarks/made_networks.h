#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "core/base/random.h"
#include "tests/train/chains.h"
#include "tests/train/trace.h"
#include "train/checkpoint/checkpoint.h"
#include "train/layers/lie_kinematics.h"
#include "train/recognisers/gru_pass.h"

namespace mocurate::benchmarks {

/// The skeleton of HumanAct12 with its chains, bones of 0.2 m.
inline SkeletonPtr HumanAct12Skeleton() {
  const LieChains chains = HumanAct12Chains();
  const LieLayer layer(chains, LieExp::kReleased);
  auto skeleton = std::make_shared<Skeleton>();
  skeleton->name = "humanact12";
  skeleton->lie = chains;
  for (int j = 0; j < 24; ++j) {
    Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.parent = j == 0 ? -1 : layer.parents()[static_cast<std::size_t>(j)];
    joint.rest_offset = 0.2 * chains.raw_offsets[static_cast<std::size_t>(j)];
    joint.mirror = j;
    skeleton->joints.push_back(joint);
  }
  return skeleton;
}

/// Random parameters, uniform in +-0.088 as in PyTorch's initialisation.
inline void FillRandomly(ParameterList& parameters) {
  Random random(0, "benchmark");
  for (Parameter& parameter : parameters) {
    std::int64_t count = 1;
    for (const std::int64_t size : parameter.shape) count *= size;
    for (std::int64_t k = 0; k < count; ++k) {
      parameter.value.push_back(static_cast<float>(random.Uniform(-0.088, 0.088)));
    }
  }
}

/// A checkpoint of a network with random values: 12 classes of HumanAct12.
inline Checkpoint RandomCheckpoint(const NetworkOptions& options) {
  TracedNetwork network;
  network.options = options;
  network.chains = HumanAct12Chains();
  Checkpoint checkpoint;
  checkpoint.options = OptionsToJson(options);
  checkpoint.kind = checkpoint.options.at("kind").get<std::string>();
  checkpoint.facts = {{"rate", "15"}};
  for (int c = 0; c < 12; ++c) checkpoint.labels.push_back("label" + std::to_string(c));
  checkpoint.skeleton = HumanAct12Skeleton();
  for (const auto& [name, shape] : ShapesOf(network)) checkpoint.parameters.push_back({name, shape, {}});
  FillRandomly(checkpoint.parameters);
  return checkpoint;
}

}  // namespace mocurate::benchmarks
