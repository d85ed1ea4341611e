#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/config.h"
#include "core/base/error.h"
#include "eval/options.h"

namespace mocurate {

/// A protocol of configs/protocols by its name, or a YAML file, with `--set` assignments. Error kUsage lists them.
Expected<ProtocolOptions> LoadProtocol(const std::string& name_or_path, const std::vector<std::string>& assignments,
                                       const ConfigRules& rules);

/// An extractor of configs/extractors by its name, a YAML file, or a checkpoint of mocurate (.h5), which declares
/// everything itself. `assignments` as of --set, without the prefix "extractor.". Error kUsage lists the extractors.
Expected<ExtractorOptions> LoadExtractor(const std::string& name_or_path, const std::vector<std::string>& assignments,
                                         const ConfigRules& rules);

std::vector<std::string> ProtocolNames();

/// The papers' numbers of a data set, those of `paper` first (PublishedOf); empty for an empty name.
Expected<nlohmann::json> PublishedNumbers(const std::string& paper, const std::string& dataset);

/// Path of an extractor's weights: the path itself, else a file of that name below the folder MOCURATE_WEIGHTS. Error
/// kMissingOnHost with the searched places and where to obtain them.
Expected<std::filesystem::path> FindWeights(const ExtractorOptions& extractor);

}  // namespace mocurate
