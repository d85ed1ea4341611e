#include "core/formats/trc.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "core/base/text.h"
#include "core/formats/line_reader.h"

namespace mocurate {
namespace {

constexpr double kHole = std::numeric_limits<double>::quiet_NaN();

class TrcParser {
 public:
  TrcParser(std::string_view bytes, const std::string& name, DamagedRows damaged_rows)
      : lines_(bytes, name),
        ends_in_line_(!bytes.empty() && (bytes.back() == '\n' || bytes.back() == '\r')),
        reports_(damaged_rows == DamagedRows::kReport) {}

  Expected<TrcFile> Run() {
    if (lines_.Peek().empty()) return EmptyFile(lines_.name());
    if (Status read = Header(); !read) return Forward(read);
    if (Status read = Names(); !read) return Forward(read);
    if (Status read = Rows(); !read) return Forward(read);
    return std::move(trc_);
  }

 private:
  /// The cells of a line; runs of blanks separate where the line of names has neither tabs nor commas.
  static std::vector<std::string_view> CellsOf(std::string_view line, char separator) {
    std::vector<std::string_view> cells;
    Split(line, separator, cells);
    return cells;
  }
  /// The same into a vector that keeps its memory from row to row.
  static void Split(std::string_view line, char separator, std::vector<std::string_view>& cells) {
    cells.clear();
    if (separator == ' ') {
      cells = SplitBlanks(line);
      return;
    }
    for (std::size_t end = 0; end != std::string_view::npos; line.remove_prefix(std::min(line.size(), end + 1))) {
      end = line.find(separator);
      const std::string_view cell = line.substr(0, end);
      cells.push_back(cell.empty() ? cell : Trim(cell));
      if (end == std::string_view::npos) break;
    }
  }
  static char SeparatorOf(std::string_view line) {
    return line.find('\t') != std::string_view::npos ? '\t' : line.find(',') != std::string_view::npos ? ',' : ' ';
  }

  Status Header() {
    const std::string_view first = lines_.Next();
    const std::size_t word = first.find_first_of(" \t,");
    if (!SameWord(first.substr(0, word), "PathFileType"))
      return lines_.Bad("the first line begins with '" + Shown(first.substr(0, word)) + "', not PathFileType");
    if (const std::size_t axes = first.find("(X/Y/Z)"); axes != std::string_view::npos)
      trc_.recorded = std::string(Trim(first.substr(axes + 7)));
    const std::string_view keys = lines_.Next();
    if (keys.empty()) return lines_.CutOff("the line of DataRate and other keys");
    const char separator = SeparatorOf(keys);
    const std::vector<std::string_view> called = CellsOf(keys, separator);
    const std::string_view line = lines_.Next();
    if (line.empty()) return lines_.CutOff("the line of values below the keys");
    std::vector<std::string_view> values = CellsOf(line, separator);
    if (separator == ' ' && values.size() != called.size())
      return lines_.Bad(Counted(static_cast<long long>(values.size()), "value") + " for " +
                        Counted(static_cast<long long>(called.size()), "key"));
    values.resize(std::max(values.size(), called.size()));
    for (std::size_t i = 0; i < called.size(); ++i) {
      if (SameWord(called[i], "Units")) trc_.units = std::string(values[i]);
      for (const auto& [key, number] : {std::pair("DataRate", &trc_.rate_hz), std::pair("NumFrames", &announced_rows_),
                                        std::pair("NumMarkers", &announced_markers_)}) {
        if (!SameWord(called[i], key) || values[i].empty()) continue;
        const std::optional<double> value = ParseDouble(values[i]);
        if (!value || !(*value >= 0.0) || *value > kLargestNumber)
          return lines_.Bad(std::string(key) + " '" + Shown(values[i]) + "' is not a count or a rate");
        *number = *value;
      }
    }
    return {};
  }

  Status Names() {
    const std::string_view line = lines_.Next();
    if (line.empty()) return lines_.CutOff("the line of Frame#, Time and names");
    separator_ = SeparatorOf(line);
    std::vector<std::string_view> cells = CellsOf(line, separator_);
    while (!cells.empty() && cells.back().empty()) cells.pop_back();
    if (cells.size() < 3 || !SameWord(cells[0].substr(0, 5), "Frame") || !SameWord(cells[1].substr(0, 4), "Time"))
      return lines_.Bad("the line does not begin with Frame#, Time and a name: '" + Shown(line) + "'");
    // A name has two empty cells behind it, over the columns of y and z; some programs leave them out.
    const bool apart = separator_ != ' ' && cells.size() > 3 && cells[3].empty();
    std::set<std::string_view> seen;
    for (std::size_t c = 2; c < cells.size(); c += apart ? 3 : 1) {
      if (cells[c].empty()) return lines_.Bad("the name in column " + std::to_string(c + 1) + " is empty");
      if (!seen.insert(cells[c]).second) return lines_.Bad("the name '" + Shown(cells[c]) + "' appears twice");
      for (std::size_t k = c + 1; apart && k < std::min(c + 3, cells.size()); ++k) {
        if (!cells[k].empty())
          return lines_.Bad("column " + std::to_string(k + 1) + " has the name '" + Shown(cells[k]) +
                            "' over y or z of '" + Shown(cells[c]) + "'");
      }
      trc_.names.emplace_back(cells[c]);
    }
    const auto count = static_cast<double>(trc_.names.size());
    if (announced_markers_ != 0.0 && announced_markers_ != count) {
      trc_.findings.push_back(MakeFinding(
          "count_contradiction", Severity::kWarning, announced_markers_,
          "NumMarkers announces " + FormatDouble(announced_markers_) + ", " + FormatDouble(count) + " are named"));
    }
    if (!lines_.Peek().empty() && IsLineOfAxes(lines_.Peek())) (void)lines_.Next();
    return {};
  }

  /// "X1 Y1 Z1 X2 ..."
  static bool IsLineOfAxes(std::string_view line) {
    return line.size() > 1 && (line[0] == 'X' || line[0] == 'x') && line[1] >= '0' && line[1] <= '9';
  }

  Status Rows() {
    const std::size_t markers = trc_.names.size();
    long long unnamed = 0;
    std::vector<std::string_view> cells;
    const std::size_t at_end = CellsAtTheEnd(markers);
    for (std::string_view before = lines_.rest(), line = lines_.Next(); !line.empty();
         before = lines_.rest(), line = lines_.Next()) {
      Split(line, separator_, cells);
      const std::optional<long long> number = ParseInteger(cells[0]);
      const int last = trc_.frame_number.empty() ? std::numeric_limits<int>::min() : trc_.frame_number.back();
      if (!number || *number <= last || *number > 2147483647) {
        return lines_.Bad("frame '" + Shown(cells[0]) + "' is no number above that of the row before",
                          "rows must be in the order of time");
      }
      if (separator_ == ' ' && cells.size() != 2 + 3 * markers) {
        return lines_.Bad("the row has " + Counted(static_cast<long long>(cells.size()), "number") + ", " +
                              std::to_string(markers) + " markers take " + std::to_string(2 + 3 * markers),
                          "blanks alone cannot show a hole: write tabs");
      }
      trc_.frame_number.push_back(static_cast<int>(*number));
      const std::size_t count = cells.size() + EmptyCellsAfter(line, before);
      if (separator_ != ' ' &&
          (count < 2 + 3 * markers ||
           (count - 2) % 3 != at_end)) {  // which cell is missing is unknown: all behind it would be another marker's
        const std::string what = "the row has " + std::to_string(count) + " cells, " + std::to_string(markers) +
                                 " markers take " + std::to_string(2 + 3 * markers);
        if (!reports_) return lines_.Bad(what, "write an empty cell for each number of a hole");
        AddFinding("row_length", what);
        trc_.time_s.push_back(kHole);
        trc_.values.insert(trc_.values.end(), 3 * markers, kHole);
        continue;
      }
      const auto time = Number(cells, 1);
      if (!time) return Forward(time);
      trc_.time_s.push_back(*time);
      for (std::size_t m = 0; m < markers; ++m) {
        if (Status read = Marker(cells, m); !read) return read;
      }
      for (std::size_t c = 2 + 3 * markers; c < cells.size(); ++c) unnamed += cells[c].empty() ? 0 : 1;
    }
    if (trc_.frame_number.empty()) return lines_.CutOff("a row of numbers");
    if (!ends_in_line_ && announced_rows_ > trc_.rows()) {  // its last number may be cut too
      trc_.frame_number.pop_back();
      trc_.time_s.pop_back();
      trc_.values.resize(trc_.values.size() - 3 * markers);
    }
    if (unnamed > 0) {
      trc_.findings.push_back(MakeFinding(
          "unnamed_points", Severity::kInfo, static_cast<double>(unnamed / 3),
          Counted(unnamed / 3, "sample") + " of markers without a name, behind the last column with one, are left out",
          FindingAction::kExcluded));
    }
    return CheckCount();
  }

  /// Empty cells between the last one that is not, and the end of the line: `line` is trimmed, `before` the text from
  /// it on.
  std::size_t EmptyCellsAfter(std::string_view line, std::string_view before) const {
    if (separator_ == ' ') return 0;
    const auto end = static_cast<std::size_t>(line.data() + line.size() - before.data());
    const std::string_view after = before.substr(end, before.find_first_of("\r\n", end) - end);
    return static_cast<std::size_t>(std::count(after.begin(), after.end(), separator_));
  }

  /// Cells that rows have beyond whole markers: 1 where most end with a separator, else 0.
  std::size_t CellsAtTheEnd(std::size_t markers) const {
    long long votes[2] = {0, 0};
    for (std::string_view rest = lines_.rest(); !rest.empty();) {
      const std::size_t end = std::min(rest.size(), rest.find_first_of("\r\n"));
      const auto cells = 1 + static_cast<std::size_t>(
                                 std::count(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(end), separator_));
      if (cells >= 2 + 3 * markers && (cells - 2) % 3 < 2) ++votes[(cells - 2) % 3];
      rest.remove_prefix(std::min(rest.size(), end + 1));
    }
    return votes[1] > votes[0] ? 1 : 0;
  }

  Status Marker(const std::vector<std::string_view>& cells, std::size_t marker) {
    double place[3];
    int holes = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto value = Number(cells, 2 + 3 * marker + k);
      if (!value) return Forward(value);
      place[k] = *value;
      holes += std::isnan(*value) ? 1 : 0;
    }
    if (holes == 1 || holes == 2) {
      const std::string what = "'" + Shown(trc_.names[marker]) + "' has " + Counted(3 - holes, "number") + ", not 3";
      if (!reports_) return lines_.Bad(what, "write all three, or leave all empty for a hole");
      AddFinding("row_length", what);
    }
    for (const double value : place) trc_.values.push_back(holes > 0 ? kHole : value);
    return {};
  }

  /// A cell; NaN where it is empty or says so, or, where that is reported, where it is no number.
  Expected<double> Number(const std::vector<std::string_view>& cells, std::size_t column) {
    if (column >= cells.size() || cells[column].empty()) return kHole;
    const std::optional<double> value = ParseDouble(cells[column]);
    if (value && std::abs(*value) <= kLargestCoordinate) return *value;
    if (SameWord(cells[column], "nan")) return kHole;
    const std::string what = "column " + std::to_string(column + 1) + " has '" + Shown(cells[column]) +
                             (value ? "', beyond any coordinate" : "', not a number");
    if (!reports_)
      return lines_.Bad(what, value ? kCoordinateHint : "write numbers with points, and holes as empty cells");
    AddFinding("not_a_number", what);
    return kHole;
  }

  /// One finding a code, with the first row of it.
  void AddFinding(const char* code, const std::string& what) {
    const auto [known, is_new] = finding_of_.emplace(code, trc_.findings.size());
    if (is_new) {
      const int row = trc_.rows() - 1;
      trc_.findings.push_back(FindingOfFrames(
          code, row, row + 1, 0.0, "line " + std::to_string(lines_.number()) + ": " + what, FindingAction::kMissing));
    }
    trc_.findings[known->second].value += 1.0;
    trc_.findings[known->second].frame_end = trc_.rows();
  }

  Status CheckCount() {
    const auto rows = static_cast<double>(trc_.rows());
    if (announced_rows_ == 0.0 || announced_rows_ == rows) return {};
    if (announced_rows_ > rows && !reports_)
      return CountContradiction("NumFrames", announced_rows_, rows, lines_.name());
    trc_.findings.push_back(MakeFinding(
        announced_rows_ > rows ? "cut_off" : "count_contradiction",
        announced_rows_ > rows ? Severity::kError : Severity::kWarning, announced_rows_,
        "NumFrames announces " + FormatDouble(announced_rows_) + ", " + FormatDouble(rows) + " rows follow"));
    return {};
  }

  LineReader lines_;
  const bool ends_in_line_;
  const bool reports_;
  TrcFile trc_;
  char separator_ = '\t';
  double announced_rows_ = 0.0, announced_markers_ = 0.0;
  std::map<std::string, std::size_t> finding_of_;  ///< by code
};

}  // namespace

Expected<TrcFile> ParseTrc(std::string_view bytes, const std::string& name, DamagedRows damaged_rows) {
  return TrcParser(bytes, name, damaged_rows).Run();
}

std::string WriteTrc(const TrcFile& trc) {
  const std::string rate = FormatDouble(trc.rate_hz), rows = std::to_string(trc.rows());
  const std::string first = std::to_string(trc.frame_number.empty() ? 1 : trc.frame_number.front());
  std::string text =
      "PathFileType\t4\t(X/Y/Z)\t" + trc.recorded +
      "\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n" + rate +
      "\t" + rate + "\t" + rows + "\t" + std::to_string(trc.names.size()) + "\t" + trc.units + "\t" + rate + "\t" +
      first + "\t" + rows + "\nFrame#\tTime";
  for (const std::string& name : trc.names) text += "\t" + name + "\t\t";
  text += "\n\t";
  for (std::size_t m = 1; m <= trc.names.size(); ++m) {
    for (const char axis : {'X', 'Y', 'Z'}) text += "\t" + std::string(1, axis) + std::to_string(m);
  }
  text += "\n\n";
  const std::size_t columns = 3 * trc.names.size();
  for (std::size_t row = 0; row < trc.frame_number.size(); ++row) {
    text += std::to_string(trc.frame_number[row]) + "\t";
    if (!std::isnan(trc.time_s[row])) text += FormatDouble(trc.time_s[row]);
    for (std::size_t c = 0; c < columns; ++c) {
      const double value = trc.values[row * columns + c];
      text += "\t";
      if (!std::isnan(value)) text += FormatDouble(value);
    }
    text += "\n";
  }
  return text;
}

}  // namespace mocurate
