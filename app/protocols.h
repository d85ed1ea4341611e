#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "eval/options.h"

namespace mocurate {

/// A protocol of configs/protocols by its name, or a YAML file, with `--set` assignments. Error kUsage lists them.
Expected<ProtocolOptions> LoadProtocol(const std::string& name_or_path, const std::vector<std::string>& assignments);

/// An extractor of configs/extractors by its name, a YAML file, or a checkpoint of ours (.h5), which says everything
/// itself. Error kUsage lists them.
/// `assignments` as of --set, without the prefix "extractor.".
Expected<ExtractorOptions> LoadExtractor(const std::string& name_or_path,
                                         const std::vector<std::string>& assignments = {});

std::vector<std::string> ProtocolNames();

/// The papers' numbers of a data set, those of `paper` first (PublishedOf); none for an empty name.
Expected<nlohmann::json> PublishedNumbers(const std::string& paper, const std::string& dataset);

/// Where the weights of an extractor lie: at the path itself, else by that name below the folder MOCURATE_WEIGHTS.
/// Error kMissingOnHost says where they were looked for and where they come from.
Expected<std::filesystem::path> FindWeights(const ExtractorOptions& extractor);

}  // namespace mocurate
