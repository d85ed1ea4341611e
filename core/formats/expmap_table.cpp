#include "core/formats/expmap_table.h"

#include <algorithm>
#include <utility>

#include "core/formats/joint_table.h"
#include "core/formats/line_reader.h"

namespace mocurate {
namespace {

constexpr int kMostColumns = 3000;

std::vector<std::string> Names(int columns) {
  std::vector<std::string> names = {"root x", "root y", "root z"};
  for (int c = 3; c < columns; ++c) {
    names.push_back("rotation of joint " + std::to_string((c - 3) / 3) + ", " + "xyz"[c % 3]);
  }
  return names;
}

int ColumnsOfFirstRow(std::string_view bytes, const std::string& name) {
  const std::string_view row = LineReader(bytes, name).Next();
  const auto commas = std::count(row.begin(), row.end(), ',');
  const bool trailing = !row.empty() && row.back() == ',';
  return row.empty() || commas > kMostColumns ? 0 : static_cast<int>(commas) + (trailing ? 0 : 1);
}

}  // namespace

Expected<ExpmapTable> ParseExpmapTable(std::string_view bytes, const std::string& name, int columns,
                                       DamagedRows damaged_rows) {
  JointTableLayout layout;
  layout.columns = columns > 0 ? columns : ColumnsOfFirstRow(bytes, name);
  layout.damaged_rows = layout.columns > 0 ? damaged_rows : DamagedRows::kRefuse;
  const bool fits = layout.columns >= 6 && layout.columns % 3 == 0 && layout.columns <= kMostColumns;
  if (fits) layout.column_names = Names(layout.columns);
  Expected<JointTable> read = ParseJointTable(bytes, layout, name);
  if (!read) return Forward(read);
  if (!fits) {
    return Fail(ErrorCode::kMalformed,
                std::to_string(read->columns) + " columns are not a root position and rotation vectors of 3 numbers",
                LineReader(bytes, name).Place(1), "99 columns are 32 joints, 117 are 38");
  }
  ExpmapTable table;
  table.frames = read->frames;
  table.joints = read->columns / 3 - 1;
  table.findings = std::move(read->findings);
  for (int f = 0; f < table.frames; ++f) {
    const auto row = read->values.begin() + static_cast<std::ptrdiff_t>(f) * read->columns;
    table.root.insert(table.root.end(), row, row + 3);
    table.rotation_rad.insert(table.rotation_rad.end(), row + 3, row + read->columns);
  }
  return table;
}

}  // namespace mocurate
