#include "core/formats/joint_table.h"

#include <limits>

#include "core/base/text.h"
#include "core/formats/number_scanner.h"

namespace mocurate {
namespace {

std::string Place(const std::string& name, int line) { return name + ":" + std::to_string(line); }

std::string Shown(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string shown;
  for (const char c : text.substr(0, kLongest)) shown += (c >= ' ' && c < 127) ? c : '?';
  return text.size() > kLongest ? shown + "..." : shown;
}

}  // namespace

Expected<JointTable> ParseJointTable(std::string_view bytes, const JointTableLayout& layout, const std::string& name) {
  if (layout.rows_per_frame < 1) return Fail(ErrorCode::kUsage, "rows_per_frame must be at least 1", name);
  JointTable table;
  table.rows_per_frame = layout.rows_per_frame;
  table.columns = layout.columns;
  table.values.reserve(bytes.size() / 10);
  NumberScanner scanner(bytes, layout.separator != JointTableLayout::Separator::kBlanks);
  long long rows = 0;
  int in_row = 0;
  int line = 1;  // of the row being read
  for (bool more = true; more;) {
    const NumberScanner::Token token = scanner.Next();
    switch (token) {
      case NumberScanner::Token::kNumber:
        table.values.push_back(scanner.value());
        ++in_row;
        break;
      case NumberScanner::Token::kNotFinite:
        if (!layout.allow_nan) {
          return Fail(ErrorCode::kMalformed, "'" + Shown(scanner.text()) + "' is not a finite number",
                      Place(name, scanner.line()), "a missing joint is declared with `missing: nan`");
        }
        table.values.push_back(std::numeric_limits<double>::quiet_NaN());
        ++in_row;
        break;
      case NumberScanner::Token::kWord:
        return Fail(ErrorCode::kMalformed, "'" + Shown(scanner.text()) + "' is not a number",
                    Place(name, scanner.line()), "a joint table holds rows of numbers only, without a header");
      case NumberScanner::Token::kEnd:
        more = false;
        [[fallthrough]];
      case NumberScanner::Token::kLineEnd:
        if (in_row > 0) {
          if (table.columns == 0) table.columns = in_row;
          if (in_row != table.columns) {
            return Fail(ErrorCode::kMalformed,
                        "row has " + std::to_string(in_row) + " numbers, not " + std::to_string(table.columns),
                        Place(name, line), "every row must have the declared columns; is the file cut off?");
          }
          ++rows;
        }
        in_row = 0;
        line = scanner.line();
        break;
    }
  }
  if (rows == 0) return Fail(ErrorCode::kMalformed, "the file holds no numbers", name, "is the file empty?");
  if (rows % layout.rows_per_frame != 0) {
    return Fail(ErrorCode::kMalformed,
                std::to_string(rows) + " rows are not a whole number of frames of " +
                    std::to_string(layout.rows_per_frame) + " rows (" + std::to_string(rows % layout.rows_per_frame) +
                    " left over)",
                Place(name, line), "check rows_per_frame, or the file is cut off");
  }
  const long long frames = rows / layout.rows_per_frame;
  if (frames > std::numeric_limits<int>::max()) return Fail(ErrorCode::kUnsupported, "too many frames", name);
  table.frames = static_cast<int>(frames);
  return table;
}

std::string WriteJointTable(const JointTable& table, char separator) {
  std::string text;
  text.reserve(table.values.size() * 12);
  for (std::size_t i = 0; i < table.values.size(); ++i) {
    text += FormatDouble(table.values[i]);
    text += (i + 1) % static_cast<std::size_t>(table.columns) == 0 ? '\n' : separator;
  }
  return text;
}

}  // namespace mocurate
