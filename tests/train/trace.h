#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/motion/skeleton.h"
#include "train/checkpoint/parameters.h"
#include "train/options.h"

namespace mocurate {

/// For comparison with other implementations: a network with given weights, inputs and draws. The interface has no
/// libtorch types, and the same three functions trace all networks.
struct TracedNetwork {
  NetworkOptions options;
  int joints = 24;
  int classes = 12;
  LieChains chains;
  std::vector<int> parents;           ///< (J)
  std::vector<Vector3d> rest_offset;  ///< (J)
  int words = 0;                      ///< of the vocabulary, where a network learns from segments
  ParameterList weights;              ///< by name; missing ones keep their initial values
};

/// A named array; `value` of integers and truth values as numbers.
using TraceValues = std::map<std::string, Parameter>;

/// Training steps on one batch in one shard.
struct TraceBatch {
  int frames = 0;
  std::vector<float> motion;       ///< (T,B,3J); or empty
  std::vector<float> features;     ///< (T,B,F) frames as the network reads them; or empty
  std::vector<int> length;         ///< (B) valid frames; empty: all
  std::vector<int> label;          ///< (B)
  std::vector<int> parts, word;    ///< (B,3) frames and labels of the segments; or empty
  std::vector<TraceValues> draws;  ///< of each step, by purpose; their number is the number of steps
  int phase = 0;
};

/// Results of the steps: terms, outputs and gradients of the first, parameters after each.
struct StepTrace {
  double total = 0.0;
  std::vector<double> totals;  ///< of every step
  std::map<std::string, double> terms;
  TraceValues outputs, gradients;
  std::vector<ParameterList> after;
};

/// Error kInconsistent where weights do not match the network.
Expected<StepTrace> TraceStep(const TracedNetwork& network, const TraceBatch& batch);

/// NetworkParts on `inputs`; with `cotangents`, the gradients of their inner product with the parts.
struct PartsTrace {
  TraceValues parts, gradients;
};
Expected<PartsTrace> TraceParts(const TracedNetwork& network, const TraceValues& inputs,
                                const TraceValues& cotangents = {});

/// Motions for labels: "joints" and "output", (T,B,3J).
Expected<TraceValues> TraceAnswer(const TracedNetwork& network, const std::vector<int>& label, int frames,
                                  const std::vector<float>& bone_length, const TraceValues& draws);

/// Names and shapes of the parameters, in the order in which they are registered.
std::vector<std::pair<std::string, std::vector<std::int64_t>>> ShapesOf(const TracedNetwork& network);

/// Values of parameters and statistics before the first step.
ParameterList InitialValues(const TracedNetwork& network);

/// Number of learned values by the first part of their names ("prior", "decoder", ...).
std::map<std::string, std::int64_t> CountOfParts(const TracedNetwork& network);

}  // namespace mocurate
