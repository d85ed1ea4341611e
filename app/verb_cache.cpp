#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/verbs.h"
#include "core/base/file.h"
#include "core/pipeline/runner.h"

namespace mocurate {
namespace {

void Print(CommonArguments& common, const nlohmann::json& document, const std::string& text) {
  common.answered = common.json;
  std::printf("%s\n", common.json ? document.dump(1).c_str() : text.c_str());
}

}  // namespace

Status CacheVerb(CommonArguments& common, const CacheArguments& arguments) {
  Cache cache(DefaultCacheFolder());
  const std::string folder = DisplayPath(cache.folder());
  if (arguments.action == "verify") {
    const std::vector<std::string> damaged = cache.Verify();
    std::string text = folder + ": " + std::to_string(damaged.size()) + " damaged objects";
    for (const std::string& key : damaged) text += "\n  " + key;
    Print(common, {{"folder", folder}, {"damaged", damaged}}, text);
    if (damaged.empty()) return {};
    return Fail(ErrorCode::kInconsistent, std::to_string(damaged.size()) + " cache objects differ from their hash",
                folder, "delete them (mocurate cache prune --days 0 removes all); they are made again");
  }
  const Cache::Statistics statistics = arguments.action == "prune" ? cache.Prune(arguments.days) : cache.Stat();
  Print(
      common,
      {{"folder", folder}, {"objects", statistics.objects}, {"bytes", statistics.bytes}, {"action", arguments.action}},
      folder + ": " + (arguments.action == "prune" ? "removed " : "") + std::to_string(statistics.objects) +
          " objects, " + std::to_string(statistics.bytes / 1000000) + " MB");
  return {};
}

}  // namespace mocurate
