#include "tests/train/trace.h"

#include "tests/train/network_parts.h"
#include "train/trainer/optimisers.h"
#include "train/trainer/values.h"

namespace mocurate {
namespace {

using torch::Tensor;

Tensor LabelsOf(const std::vector<int>& label) {
  return torch::tensor(std::vector<std::int64_t>(label.begin(), label.end()), torch::kInt64);
}

NetworkSizes SizesOfTraced(const TracedNetwork& traced) {
  NetworkSizes sizes;
  sizes.joints = traced.joints;
  sizes.classes = traced.classes;
  sizes.chains = traced.chains;
  sizes.parents = traced.parents;
  sizes.rest_offset = traced.rest_offset;
  sizes.words = traced.words;
  return sizes;
}

Tensor FramesOfTrace(const std::vector<float>& values, int frames, std::int64_t batch) {
  if (values.empty()) return {};
  return torch::from_blob(const_cast<float*>(values.data()),
                          {frames, batch, static_cast<std::int64_t>(values.size()) / (frames * batch)})
      .clone();
}

Expected<std::shared_ptr<Network>> BuildTraced(const TracedNetwork& traced) {
  torch::set_num_threads(1);
  auto network = MakeNetwork(traced.options, SizesOfTraced(traced));
  ParameterList values = ValuesOf(*network);
  for (const Parameter& weight : traced.weights) {
    const int at = FindParameter(values, weight.name);
    if (at < 0) return Fail(ErrorCode::kInconsistent, "the network has no parameter '" + weight.name + "'", "weights");
    values[static_cast<std::size_t>(at)] = weight;
  }
  if (Status set = SetValues(values, "weights", *network); !set) return Forward(set);
  return network;
}

void Give(const TraceValues& values, Draws& draws) {
  for (const auto& [purpose, value] : values) draws.Give(purpose, TensorOf(value));
}

}  // namespace

Expected<StepTrace> TraceStep(const TracedNetwork& traced, const TraceBatch& given) {
  const auto network = BuildTraced(traced);
  if (!network) return Forward(network);
  Optimisers optimisers(**network);
  Batch batch;
  batch.whole = static_cast<std::int64_t>(given.label.size());
  batch.label = LabelsOf(given.label);
  batch.motion = FramesOfTrace(given.motion, given.frames, batch.whole);
  batch.features = FramesOfTrace(given.features, given.frames, batch.whole);
  if (!given.length.empty()) {
    const Tensor length = LabelsOf(given.length).unsqueeze(0);  // (1,B)
    batch.valid = torch::arange(given.frames).unsqueeze(1) < length;
    batch.whole_frames = length.sum().item<std::int64_t>();
  }
  if (!given.parts.empty()) {
    batch.parts = LabelsOf(given.parts).view({batch.whole, 3});
    batch.word = LabelsOf(given.word).view({batch.whole, 3});
  }
  const std::vector<Tensor>& parameters = optimisers.group(given.phase).parameters;
  StepTrace trace;
  for (std::size_t step = 0; step < given.draws.size(); ++step) {
    Draws draws(0, static_cast<std::int64_t>(step), given.phase, 0);
    Give(given.draws[step], draws);
    const Losses losses = (*network)->Loss(batch, draws, given.phase);
    const auto gradients = torch::autograd::grad({losses.total}, parameters, {}, false, false, true);
    trace.totals.push_back(losses.total.item<double>());
    if (step == 0) {
      trace.total = losses.total.item<double>();
      for (const auto& [name, value] : losses.terms) trace.terms[name] = value.item<double>();
      for (const auto& [name, value] : losses.outputs) trace.outputs[name] = ParameterOf(name, value);
      for (const auto& named : (*network)->named_parameters()) {
        for (std::size_t i = 0; i < parameters.size(); ++i) {
          if (!named.value().is_same(parameters[i]) || !gradients[i].defined()) continue;
          trace.gradients[named.key()] = ParameterOf(named.key(), gradients[i]);
        }
      }
    }
    optimisers.Step(given.phase, gradients, 1.0, 0.0);
    (*network)->AfterStep(given.phase);
    trace.after.push_back(ValuesOf(**network));
  }
  return trace;
}

Expected<PartsTrace> TraceParts(const TracedNetwork& traced, const TraceValues& inputs, const TraceValues& cotangents) {
  const auto network = BuildTraced(traced);
  if (!network) return Forward(network);
  NamedTensors given;
  for (const auto& [name, value] : inputs) given[name] = TensorOf(value);
  const NamedTensors parts = NetworkParts::Of(**network, given);
  PartsTrace trace;
  for (const auto& [name, value] : parts) trace.parts[name] = ParameterOf(name, value);
  if (cotangents.empty()) return trace;
  Tensor product = torch::zeros({});
  for (const auto& [name, value] : cotangents) product = product + (parts.at(name) * TensorOf(value)).sum();
  const auto gradients =
      torch::autograd::grad({product}, (*network)->parameters(), {}, false, false, /*allow_unused=*/true);
  const auto named = (*network)->named_parameters();
  for (std::size_t i = 0; i < named.size(); ++i) {
    if (gradients[i].defined()) trace.gradients[named[i].key()] = ParameterOf(named[i].key(), gradients[i]);
  }
  return trace;
}

Expected<TraceValues> TraceAnswer(const TracedNetwork& traced, const std::vector<int>& label, int frames,
                                  const std::vector<float>& bone_length, const TraceValues& given) {
  const auto network = BuildTraced(traced);
  if (!network) return Forward(network);
  (*network)->eval();
  const torch::NoGradGuard no_gradient;
  RequestBatch requests;
  requests.label = LabelsOf(label);
  requests.frames = frames;
  const auto B = static_cast<std::int64_t>(label.size());
  requests.bone_length = bone_length.empty()
                             ? torch::ones({B, traced.joints})
                             : torch::from_blob(const_cast<float*>(bone_length.data()), {B, traced.joints}).clone();
  Draws draws(std::vector<std::uint64_t>(label.size(), 0));
  Give(given, draws);
  const Motions motions = (*network)->Answer(requests, draws);
  return TraceValues{{"joints", ParameterOf("joints", motions.joints)},
                     {"output", ParameterOf("output", motions.output)}};
}

std::vector<std::pair<std::string, std::vector<std::int64_t>>> ShapesOf(const TracedNetwork& traced) {
  const auto network = MakeNetwork(traced.options, SizesOfTraced(traced));
  std::vector<std::pair<std::string, std::vector<std::int64_t>>> shapes;
  for (const auto& named : network->named_parameters()) shapes.emplace_back(named.key(), named.value().sizes().vec());
  return shapes;
}

ParameterList InitialValues(const TracedNetwork& traced) {
  return ValuesOf(*MakeNetwork(traced.options, SizesOfTraced(traced)));
}

std::map<std::string, std::int64_t> CountOfParts(const TracedNetwork& traced) {
  return CountByPart(InitialValues(traced));
}

}  // namespace mocurate
