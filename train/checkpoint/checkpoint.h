#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/motion/skeleton.h"
#include "train/checkpoint/parameters.h"

namespace mocurate {

/// Kinds of networks that other programs ask for by name.
inline constexpr const char* kGruRecogniserKind = "gru_recogniser";
inline constexpr const char* kAction2MotionKind = "action2motion";
inline constexpr const char* kStGcnKind = "st_gcn";

/// What an optimiser remembers: moments of the parameters it has stepped, by their names.
struct OptimiserState {
  std::string name;
  std::int64_t steps = 0;
  ParameterList first;   ///< mean of the gradients; empty where the rule keeps none (RMSProp)
  ParameterList second;  ///< mean of their squares
};

/// A network and everything that its training needs to go on bit for bit. Random draws are keyed by the step, so `step`
/// is the position of every generator.
struct Checkpoint {
  std::string kind;                                   ///< of the network, as configs name it
  nlohmann::json options = nlohmann::json::object();  ///< NetworkOptions, complete
  nlohmann::json facts = nlohmann::json::object();    ///< about training and data; progress of the training
  std::vector<std::string> labels;                    ///< class index = position
  SkeletonPtr skeleton;                               ///< may be null (published weights)
  std::string dataset_sha256;                         ///< of the training data
  std::int64_t step = 0;
  bool finished = false;
  ParameterList parameters;
  ParameterList best;  ///< the best so far on the validation fold, or empty
  std::vector<OptimiserState> optimisers;
  std::map<std::string, std::vector<double>> history;  ///< one column per measure; "step" says where
};

/// Schema "mocurate-checkpoint/2": HDF5 with /about (JSON), /parameters, /best, /optimisers, /history. Same content,
/// same bytes; appears whole or not at all.
Status WriteCheckpoint(const Checkpoint& checkpoint, const std::filesystem::path& path);

/// The parameters as safetensors, which Python opens, with what the network is in the metadata 'mocurate'.
/// ReadCheckpoint takes such a file (ending .safetensors) as a network that is not trained any further.
Status ExportSafetensors(const Checkpoint& checkpoint, const std::filesystem::path& path);

/// Error kNotFound, kUnreadable, kMalformed; kInconsistent naming both kinds when the file holds another network than
/// `kind` (empty: any), or when it is of another version.
Expected<Checkpoint> ReadCheckpoint(const std::filesystem::path& path, const std::string& kind = {});

}  // namespace mocurate
