#include "ingest/chosen_clips.h"

#include <algorithm>
#include <filesystem>

#include "core/base/text.h"
#include "ingest/item_facts.h"

namespace mocurate {
std::string RecordingOf(const ItemSpec& item) { return item.item.substr(item.item.rfind('/') + 1); }

bool NamesClip(const std::string& wanted, const std::string& file, const std::string& place) {
  if (!place.empty() && (wanted == place || "[" + wanted + "]" == place)) return true;
  const std::filesystem::path path(file);
  for (const std::string& name : {file, path.filename().string(), path.stem().string()}) {
    if (wanted == name || (!place.empty() && wanted == name + place)) return true;
  }
  return false;
}

bool NamesClip(const std::string& wanted, const ItemSpec& item) {
  if (wanted == item.item || wanted == RecordingOf(item)) return true;
  if (wanted.compare(0, item.item.size() + 1, item.item + "#") == 0) return true;  // a clip id, with its frames
  const ItemFacts facts = FactsOf(item);
  if (wanted == facts.entry_name) return true;
  const std::string place = facts.Place();
  return std::any_of(item.inputs.begin(), item.inputs.end(), [&](const StageInput& input) {
    return input.role == "source" && NamesClip(wanted, input.name, place);
  });
}

Status TakeOnly(const std::vector<std::string>& only, Discovery& discovery) {
  constexpr std::size_t kMostClipsNamed = 5;
  if (only.empty()) return {};
  for (const std::string& wanted : only) {
    const bool known = std::any_of(discovery.items.begin(), discovery.items.end(),
                                   [&](const ItemSpec& item) { return NamesClip(wanted, item); });
    if (known) continue;
    std::vector<std::string> names;
    std::string first;
    for (const ItemSpec& item : discovery.items) {
      names.push_back(item.item);
      if (names.size() <= kMostClipsNamed) first += (first.empty() ? "" : ", ") + item.item;
    }
    return Fail(ErrorCode::kUsage, "there is no clip '" + wanted + "'", "--clip",
                DidYouMean(wanted, names,
                           "it has " + Counted(names.size(), "clip") + ": " + first +
                               (names.size() > kMostClipsNamed ? ", ..." : "") + "; `mocurate inspect` lists them"));
  }
  for (auto* items : {&discovery.items, &discovery.truth}) {
    items->erase(std::remove_if(items->begin(), items->end(),
                                [&](const ItemSpec& item) {
                                  return std::none_of(only.begin(), only.end(), [&](const std::string& wanted) {
                                    return NamesClip(wanted, item);
                                  });
                                }),
                 items->end());
  }
  return {};
}

}  // namespace mocurate
