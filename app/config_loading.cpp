#include "app/config_loading.h"

#include "core/base/resources.h"

namespace mocurate {

Expected<LoadedJob> LoadJob(const std::filesystem::path& config, const std::vector<std::string>& assignments) {
  Expected<ConfigNode> node;
  if (config.empty()) {
    const auto text = FindResource("demo.yaml");
    if (!text) return Fail(ErrorCode::kInternal, "the embedded default is missing", "demo.yaml");
    node = LoadConfig(ConfigSource{std::string(*text), "demo.yaml (embedded)", std::filesystem::current_path()},
                      assignments);
  } else {
    node = LoadConfig(config, assignments);
  }
  if (!node) return Forward(node);
  auto options = OptionsFromConfig<JobOptions>(*node);
  if (!options) return Forward(options);
  if (Status seeds = CheckSeeds(options->train); !seeds) return Forward(seeds);
  ResolveDefaults(*options);
  return LoadedJob{std::move(*node), std::move(*options)};
}

}  // namespace mocurate
