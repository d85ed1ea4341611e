#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/motion/skeleton.h"
#include "train/checkpoint/adam.h"
#include "train/checkpoint/parameters.h"

namespace mocurate {

/// Kinds of networks, as they stand in the file.
inline constexpr const char* kGruRecogniserKind = "gru_recogniser";
inline constexpr const char* kAction2MotionKind = "action2motion";

/// A network and everything that its training needs to go on bit for bit. Random draws are keyed by the step, so `step`
/// is the position of every generator.
struct Checkpoint {
  std::string kind;
  nlohmann::json options = nlohmann::json::object();  ///< of the stage, complete
  nlohmann::json facts = nlohmann::json::object();    ///< sizes and rules of the network, progress of the training
  std::vector<std::string> labels;                    ///< class index = position
  SkeletonPtr skeleton;                               ///< may be null (published weights)
  std::string dataset_sha256;                         ///< of the training data
  std::int64_t step = 0;
  bool finished = false;
  ParameterList parameters;
  ParameterList best;  ///< the best so far on the validation fold, or empty
  Adam adam;
  std::map<std::string, std::vector<double>> history;  ///< one column per measure
};

/// Schema "mocurate-checkpoint/1": HDF5 with /about (JSON), /parameters, /best, /adam, /history. Same content, same
/// bytes.
Status WriteCheckpoint(const Checkpoint& checkpoint, const std::filesystem::path& path);

/// Error kNotFound, kUnreadable, kMalformed; kInconsistent naming both kinds when the file holds another network than
/// `kind` (empty: any).
Expected<Checkpoint> ReadCheckpoint(const std::filesystem::path& path, const std::string& kind = {});

}  // namespace mocurate
