#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/motion/skeleton.h"
#include "train/checkpoint/parameters.h"

namespace mocurate {

/// Kinds of networks that other programs refer to by name.
inline constexpr const char* kGruRecogniserKind = "gru_recogniser";
inline constexpr const char* kAction2MotionKind = "action2motion";
inline constexpr const char* kStGcnKind = "st_gcn";

/// State of an optimiser: moments of the parameters it has updated, by their names.
struct OptimiserState {
  std::string name;
  std::int64_t steps = 0;
  ParameterList first;   ///< mean of the gradients; empty where the rule keeps none (RMSProp)
  ParameterList second;  ///< mean of their squares
};

/// A network and the state for continuing its training bit for bit. Random draws are keyed by the step, so that `step`
/// is the state of every generator.
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
  std::map<std::string, std::vector<double>> history;  ///< one column per measure; "step" is the index column
};

/// Schema "mocurate-checkpoint/2": HDF5 with /about (JSON), /parameters, /best, /optimisers, /history. Same content,
/// same bytes; written atomically.
Status WriteCheckpoint(const Checkpoint& checkpoint, const std::filesystem::path& path);

/// The parameters as safetensors, readable from Python, with the network's description in the metadata 'mocurate'.
/// ReadCheckpoint reads such a file (ending .safetensors) as a finished network.
Status ExportSafetensors(const Checkpoint& checkpoint, const std::filesystem::path& path);

/// Errors kNotFound, kUnreadable, kMalformed; kInconsistent naming both kinds when the file has another network than
/// `kind` (empty: any), or when it is of another version.
Expected<Checkpoint> ReadCheckpoint(const std::filesystem::path& path, const std::string& kind = {});

/// Whether an HDF5 file is declared as a checkpoint.
bool IsCheckpoint(const std::filesystem::path& path);

/// Summary of a checkpoint as JSON: network, progress, classes, skeleton, size, options. Errors of ReadCheckpoint.
Expected<nlohmann::json> DescribeCheckpoint(const std::filesystem::path& path);

/// Weights of a network that was trained elsewhere.
struct ReleasedWeights {
  ParameterList parameters;  ///< by the network's own names
  std::int64_t steps = 0;    ///< as stated in the file; 0: not stated
};

/// Weights of a network of kind `kind` from a file of torch.save, in the form of the papers' code, or from a checkpoint
/// (.h5, .safetensors). No code of the file is executed. Other content, such as an optimiser's state, is ignored.
/// Errors: those of ReadTorchPickle and ReadCheckpoint; kInconsistent for a file without such a network.
Expected<ReleasedWeights> ReadReleasedWeights(const std::filesystem::path& path, const std::string& kind);

}  // namespace mocurate
