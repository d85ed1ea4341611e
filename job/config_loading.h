#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/config.h"
#include "job/job_options.h"

namespace mocurate {

struct LoadedJob {
  ConfigNode node;  ///< with origins
  JobOptions options;
  std::string config;  ///< name of a job ("kard"), or the absolute path of a file
};

/// A job by its name (named_configs.h) or from a YAML file; an empty path gives the embedded default
/// (configs/demo.yaml).
Expected<LoadedJob> LoadJob(const std::filesystem::path& config, const std::vector<std::string>& assignments,
                            const ConfigRules& rules = {});
/// The same from a text.
Expected<LoadedJob> LoadJob(const ConfigSource& source, const std::vector<std::string>& assignments,
                            const ConfigRules& rules = {});

/// SMPL's neutral body below MOCURATE_WEIGHTS, else body_cc0.h5 there or in the test data; empty: none is there.
std::filesystem::path FindBody();

/// Looks for the body of losses on vertices that name none, and checks the networks. Errors of CheckNetworks.
Status ResolveNetworks(JobOptions& job);

}  // namespace mocurate
