#include "ingest/capture_views.h"

#include <map>
#include <set>
#include <string>

#include "ingest/sources/source_file.h"
#include "ingest/sources/view_numbers.h"

namespace mocurate {

Status GroupViews(const SourceOptions& source, std::vector<ItemSpec>& items) {
  std::map<std::string, std::map<std::string, ItemSpec>> captures;  // by item, then by view
  std::set<std::string> cameras;
  for (ItemSpec& item : items) {
    const Expected<NamedFile> named = ReadName(source, item.inputs[0].name);
    if (!named) return Forward(named);
    cameras.insert(named->identity.view);
    std::map<std::string, ItemSpec>& views = captures[item.item];
    const auto [at, added] = views.emplace(named->identity.view, item);
    if (added) continue;
    return Fail(ErrorCode::kConfig,
                "'" + at->second.inputs[0].name + "' and '" + item.inputs[0].name + "' are both '" + item.item +
                    "' seen by '" + named->identity.view + "'",
                "ingest.source.recording", "use more fields of the name in `recording` or `view`");
  }
  if (Status known = CheckFirstFrames(source, cameras); !known) return known;
  items.clear();
  for (auto& [name, views] : captures) {
    ItemSpec together = views.begin()->second;
    std::vector<StageInput> depth(together.inputs.begin() + 1, together.inputs.end());
    together.inputs.resize(1);
    for (auto view = std::next(views.begin()); view != views.end(); ++view) {
      const std::vector<StageInput>& inputs = view->second.inputs;
      together.inputs.push_back(inputs.front());
      depth.insert(depth.end(), inputs.begin() + 1, inputs.end());
      if (together.options.contains("known_issue") || !view->second.options.contains("known_issue")) continue;
      together.options.Set("known_issue", view->second.options.at("known_issue"));
    }
    together.inputs.insert(together.inputs.end(), depth.begin(), depth.end());
    items.push_back(std::move(together));
  }
  return {};
}

}  // namespace mocurate
