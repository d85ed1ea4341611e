#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/verbs.h"
#include "core/base/config.h"
#include "core/base/file.h"
#include "ingest/synthetic/studio_layouts.h"

namespace mocurate {
namespace {

Expected<ConfigNode> Load(const SynthesizeArguments& arguments) {
  std::vector<std::string> assignments = arguments.assignments;
  if (!arguments.layout.empty()) assignments.push_back("layout=" + arguments.layout);
  if (arguments.seed) assignments.push_back("seed=" + std::to_string(*arguments.seed));
  if (!arguments.config.empty()) return LoadConfig(arguments.config, assignments);
  return LoadConfig(ConfigSource{"", "synthesize", std::filesystem::current_path()}, assignments);
}

}  // namespace

Status SynthesizeVerb(CommonArguments& common, const SynthesizeArguments& arguments) {
  const Expected<ConfigNode> node = Load(arguments);
  if (!node) return Forward(node);
  const auto options = OptionsFromConfig<StudioOptions>(*node);
  if (!options) return Forward(options);
  if (arguments.show) {
    if (common.json)
      std::printf("%s\n", OptionsToJson(*options).dump(1).c_str());
    else
      std::printf("%s", ShowOptions(*options, *node, false).c_str());
    return {};
  }
  if (arguments.output.empty()) {
    return Fail(ErrorCode::kUsage, "no folder to write to", "-o", "e.g. mocurate synthesize --layout ntu -o DIR");
  }
  const auto begin = std::chrono::steady_clock::now();
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const auto counts = WriteStudioLayout(*options, arguments.output, arguments.jobs > 0 ? arguments.jobs : cores);
  if (!counts) return Forward(counts);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const std::string folder = DisplayPath(arguments.output);
  if (common.json) {
    const nlohmann::json document = {{"folder", folder},
                                     {"files", counts->files},
                                     {"bytes", counts->bytes},
                                     {"clips", counts->clips},
                                     {"frames", counts->frames},
                                     {"seconds", seconds},
                                     {"options", OptionsToJson(*options)}};
    std::printf("%s\n", document.dump(1).c_str());
  } else {
    std::printf("%s: %zu clips, %zu frames, %zu files, %.1f MB, %.1f s\n", folder.c_str(), counts->clips,
                counts->frames, counts->files, static_cast<double>(counts->bytes) / 1e6, seconds);
  }
  return {};
}

}  // namespace mocurate
