#include <algorithm>
#include <set>

#include "canon/values/relabel.h"
#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/table_text.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

Status ReadTable(const fs::path& path, std::map<std::string, std::string>& table) {
  std::error_code unknown;
  if (fs::exists(path, unknown) && !fs::is_regular_file(path, unknown)) {
    return Fail(ErrorCode::kUnreadable, "is not a file", DisplayPath(path), "name the table under `clips`");
  }
  const auto text = ReadFile(path);
  if (!text) return Forward(text);
  const std::string name = DisplayPath(path);
  std::size_t clip = 0, label = 0, columns = 0, number = 0;
  for (std::string_view line : SplitText(*text, '\n')) {
    ++number;
    if (Trim(line).empty()) continue;
    const std::string place = name + ":" + std::to_string(number);
    const auto read = CellsOfCsvLine(line);
    if (!read) return Fail(ErrorCode::kConfig, "a quote is not closed", place);
    const std::vector<std::string>& cells = *read;
    if (columns == 0) {
      columns = cells.size();
      clip = static_cast<std::size_t>(std::find(cells.begin(), cells.end(), "clip") - cells.begin());
      label = static_cast<std::size_t>(std::find(cells.begin(), cells.end(), "label") - cells.begin());
      if (clip < columns && label < columns) continue;
      return Fail(ErrorCode::kConfig,
                  std::string("the table has no column '") + (clip < columns ? "label" : "clip") + "'", place,
                  "write the columns into the first line: clip,label");
    }
    if (cells.size() != columns) {
      return Fail(
          ErrorCode::kConfig,
          Counted(static_cast<long long>(cells.size()), "column") + ", the first line has " + std::to_string(columns),
          place, "put a text with commas into double quotes");
    }
    if (cells[label].empty()) {
      return Fail(ErrorCode::kConfig, "clip '" + cells[clip] + "' has no label", place, "add one, or remove the line");
    }
    const auto [known, added] = table.emplace(cells[clip], cells[label]);
    if (added || known->second == cells[label]) continue;
    return Fail(ErrorCode::kConfig,
                "clip '" + cells[clip] + "' has the label '" + known->second + "' in an earlier line, here '" +
                    cells[label] + "'",
                place, "keep one of the lines");
  }
  return {};
}

constexpr const char* kMapFields[] = {"labels", "classes", "drop", "rules", "clips"};

bool IsPlain(const ConfigNode& node) {
  return std::all_of(node.mapping.begin(), node.mapping.end(), [](const auto& entry) {
    return entry.second.kind == ConfigNode::Kind::kScalar &&
           std::find(std::begin(kMapFields), std::end(kMapFields), entry.first) == std::end(kMapFields);
  });
}

/// Errors for labels that are named twice, and for empty ones.
Status CheckMap(const RelabelMap& map, const fs::path& path) {
  std::set<std::string> classes;
  for (const std::string& name : map.classes) {
    if (classes.insert(name).second) continue;
    return Fail(ErrorCode::kConfig, "classes lists '" + name + "' twice", DisplayPath(path));
  }
  for (const std::string& dropped : map.drop) {
    const auto renamed = map.labels.find(dropped);
    if (renamed == map.labels.end()) continue;
    return Fail(ErrorCode::kConfig, "'" + dropped + "' is dropped and becomes '" + renamed->second + "'",
                DisplayPath(path), "remove one of both");
  }
  for (const auto& [old_label, new_label] : map.labels) {
    if (!new_label.empty()) continue;
    return Fail(ErrorCode::kConfig, "'" + old_label + "' has an empty new label", DisplayPath(path),
                "remove its clips with drop: ['" + old_label + "']");
  }
  for (const RelabelRule& rule : map.rules) {
    if (!rule.label.empty()) continue;
    return Fail(ErrorCode::kConfig, "the rule has no label", rule.place, "write {where: CONDITION, label: NAME}");
  }
  return {};
}

}  // namespace

void RelabelRule::Declare(OptionVisitor& v) {
  v.Text("where", where, "condition about a clip (docs/datasets.md)");
  v.Text("label", label, "label of the clips that match");
}

void RelabelMap::Declare(OptionVisitor& v) {
  v.TextMap("labels", labels, "new label by old label");
  v.Texts("classes", classes, "labels in the order of their class indices");
  v.Texts("drop", drop, "old labels whose clips are removed");
  v.List("rules", rules, "labels by conditions; the first match counts");
  v.Path("clips", clips, "CSV with the columns clip and label");
}

Expected<RelabelMap> ReadRelabelMap(const fs::path& path) {
  const auto node = LoadData(path);
  if (!node) return Forward(node);
  RelabelMap map;
  if (IsPlain(*node)) {
    for (const auto& [old_label, new_label] : node->mapping) map.labels[old_label] = new_label.scalar;
  } else {
    auto options = OptionsFromConfig<RelabelMap>(*node);
    if (!options) return Forward(options);
    map = std::move(*options);
    const ConfigNode* rules = node->Find("rules");
    for (std::size_t i = 0; i < map.rules.size(); ++i) {
      const Origin& origin = rules->sequence[i].origin;
      map.rules[i].place = Origin{DisplayPath(path.filename()), origin.line, origin.column}.Text();
    }
  }
  map.name = DisplayPath(path.filename());
  if (!map.clips.empty()) {
    if (Status table = ReadTable(map.clips, map.table); !table) return Forward(table);
  }
  if (Status sound = CheckMap(map, path); !sound) return Forward(sound);
  if (map.labels.empty() && map.classes.empty() && map.drop.empty() && map.rules.empty() && map.table.empty()) {
    return Fail(ErrorCode::kConfig, "the map has no label", DisplayPath(path),
                "write `old: new`, or see docs/datasets.md");
  }
  return map;
}

}  // namespace mocurate
