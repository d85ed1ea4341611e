#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/links.h"
#include "core/base/log.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/pipeline/runner.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"

namespace mocurate {
Status CacheVerb(CommonArguments& common, const CacheArguments& arguments) {
  Cache cache(DefaultCacheFolder());
  if (Status plain = CheckNotLink(cache.folder() / "objects"); !plain) return plain;
  if (const std::string others = cache.OthersWhoWrite(); !others.empty()) LogWarning(others);
  const std::string folder = DisplayPath(cache.folder());
  if (arguments.action == "verify") {
    const std::vector<std::string> damaged = cache.Verify();
    const std::string count = Counted(static_cast<long long>(damaged.size()), "cache object");
    std::string text = folder + ": damaged: " + count;
    for (const std::string& key : damaged) text += "\n  " + key;
    if (AnswersInText(common, {{"folder", folder}, {"damaged", damaged}})) PrintLine(text);
    if (damaged.empty()) return {};
    return Fail(ErrorCode::kInconsistent, "damaged: " + count + " with another hash than recorded", folder,
                "delete them (mocurate cache prune --days 0 removes all objects); they are computed again when needed");
  }
  const bool prune = arguments.action == "prune";
  const Cache::Statistics statistics = prune ? cache.Prune(arguments.days, arguments.dry_run) : cache.Stat();
  const char* removed = !prune ? "" : arguments.dry_run ? "would remove " : "removed ";
  if (AnswersInText(common, {{"folder", folder},
                             {"objects", statistics.objects},
                             {"bytes", statistics.bytes},
                             {"action", arguments.action},
                             {"dry_run", arguments.dry_run}})) {
    PrintLine(folder + ": " + removed + Counted(static_cast<long long>(statistics.objects), "object") + ", " +
              std::to_string(statistics.bytes / 1000000) + " MB");
  }
  return {};
}

}  // namespace mocurate
