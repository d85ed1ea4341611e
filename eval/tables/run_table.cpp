#include "eval/tables/run_table.h"

#include <nlohmann/json.hpp>

#include "core/base/file.h"

namespace mocurate {
namespace {

struct Column {
  const char* key;
  const char* title;
  int digits;
};

constexpr Column kColumns[] = {{"fid", "FID ↓", 3},
                               {"accuracy", "Accuracy ↑", 3},
                               {"diversity", "Diversity →", 3},
                               {"multimodality", "Multimodality →", 3}};

Table::Row RowOf(const std::string& name, const nlohmann::json& metrics) {
  Table::Row row;
  row.name = name;
  for (const Column& column : kColumns) row.cells.push_back({metrics.value(column.key, std::vector<double>())});
  return row;
}

}  // namespace

Table RunTable(const nlohmann::json& metrics, const std::string& title) {
  Table table;
  table.title = title;
  for (const Column& column : kColumns) {
    table.columns.emplace_back(column.title);
    table.digits.push_back(column.digits);
  }
  for (const auto& [name, row] : metrics.at("rows").items()) {
    table.rows.insert(name == "Real" ? table.rows.begin() : table.rows.end(), RowOf(name, row));
  }
  table.notes = metrics.value("notes", std::vector<std::string>());
  return table;
}

Expected<WrittenTables> WriteTables(const nlohmann::json& metrics, const std::string& title,
                                    const std::filesystem::path& folder) {
  if (Status made = MakeFolder(folder); !made) return Forward(made);
  const Table table = RunTable(metrics, title);
  WrittenTables written;
  written.markdown = ToMarkdown(table, IntervalKind::kStudent);
  const std::pair<const char*, std::string> files[] = {
      {"table.md", written.markdown + "\n" + ToMarkdown(table, IntervalKind::kAction2Motion)},
      {"table.csv", ToCsv(table)},
      {"table.tex", ToLatex(table, IntervalKind::kStudent)},
      {"table.json", metrics.at("rows").dump(1) + "\n"}};
  for (const auto& [name, text] : files) {
    if (Status done = WriteFile(folder / name, text); !done) return Forward(done);
    written.files.push_back(folder / name);
  }
  return written;
}

}  // namespace mocurate
