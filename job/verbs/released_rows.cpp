#include "job/verbs/released_rows.h"

#include <cstdlib>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"

namespace mocurate {

namespace fs = std::filesystem;

fs::path PublishedFile(const fs::path& name) {
  const char* folder = std::getenv("MOCURATE_WEIGHTS");
  if (folder == nullptr || *folder == '\0' || name.empty()) return {};
  std::error_code unknown;
  const fs::path file = fs::path(folder) / name;
  return fs::is_regular_file(file, unknown) ? file : fs::path();
}

Expected<nlohmann::json> ReleasedRows(const ReproduceOptions& item, const std::string& set, const fs::path& folder,
                                      const CommonArguments& common) {
  nlohmann::json rows = nlohmann::json::array();
  for (const ReleasedMotionsOptions& released : item.released) {
    EvalArguments asked;
    const fs::path motions = PublishedFile(released.motions), labels = PublishedFile(released.labels);
    asked.bone_lengths = PublishedFile(released.bone_lengths);
    const bool whole = asked.bone_lengths.empty() == released.bone_lengths.empty();
    if (released.set != set || motions.empty() || labels.empty() || !whole) continue;
    asked.protocol = released.protocol;
    asked.generated = {released.name + "=" + motions.string()};
    asked.labels = {labels};
    asked.output = folder / "released" / motions.parent_path().filename();
    CommonArguments own = common;
    own.json = false;
    own.quiet = true;
    if (Status scored = EvalVerb(own, asked); !scored) {
      if (scored.error().code == ErrorCode::kInterrupted) return Forward(scored);
      LogWarning("no row '" + released.name + "': " + scored.error().Message());
      continue;
    }
    const nlohmann::json table = ReadJson(asked.output / "tables/table.json").value_or(nullptr);
    if (!table.is_object()) continue;
    for (nlohmann::json row : table.value("rows", nlohmann::json::array())) {
      if (row.value("real", false)) continue;
      row["profile"] = "released";
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace mocurate
