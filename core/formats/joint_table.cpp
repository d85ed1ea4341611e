#include "core/formats/joint_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/text.h"
#include "core/formats/file_rules.h"
#include "core/formats/line_reader.h"
#include "core/formats/number_scanner.h"

namespace mocurate {
namespace {

using Token = NumberScanner::Token;

constexpr int kFewRows = 8;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// ';' or '|' where the words between them are numbers; 0: neither.
char OtherSeparator(std::string_view line) {
  for (const char separator : {';', '|', ':'}) {
    const std::vector<std::string_view> words = SplitText(Trim(line), separator);
    const bool numbers = words.size() > 1 && std::all_of(words.begin(), words.end(), [](std::string_view word) {
                           return Trim(word).empty() || ParseDouble(Trim(word)).has_value();
                         });
    if (numbers) return separator;
  }
  return 0;
}

/// The cells of a line of a header, between commas, semicolons, tabs or blanks.
std::vector<std::string> HeaderCells(std::string_view line) {
  if (!line.empty() && (line[0] == '#' || line[0] == '%')) line.remove_prefix(1);
  const std::size_t first = line.find_first_of(",;\t");
  const bool blanks = first == std::string_view::npos;
  const char separator = blanks ? ' ' : line[first];
  std::vector<std::string> names;
  const auto add = [&](std::string_view cell) {
    cell = Trim(cell);
    if (cell.size() > 1 && cell.front() == '"' && cell.back() == '"') cell = cell.substr(1, cell.size() - 2);
    names.emplace_back(cell);
  };
  if (blanks) {
    for (const std::string_view cell : SplitBlanks(line)) add(cell);
    return names;
  }
  bool quoted = false;
  std::size_t begin = 0;
  for (std::size_t at = 0; at <= line.size(); ++at) {
    if (at < line.size() && line[at] == '"') quoted = !quoted;
    if (at < line.size() && (quoted || line[at] != separator)) continue;
    add(line.substr(begin, at - begin));
    begin = at + 1;
  }
  return names;
}

/// Whether a number that is not finite is "nan", "-NaN", "nan(ind)": not "inf", nor digits beyond a double.
bool IsNanWord(std::string_view text) {
  const std::size_t first = text.find_first_not_of("+-");
  return first != std::string_view::npos && (text[first] == 'n' || text[first] == 'N');
}

class JointTableParser {
 public:
  JointTableParser(std::string_view bytes, const JointTableLayout& layout, const std::string& name)
      : layout_(layout),
        name_(name),
        scanner_(bytes, layout.separator != JointTableLayout::Separator::kBlanks, layout.first_line) {
    table_.rows_per_frame = layout.rows_per_frame;
    table_.columns = layout.columns;
    table_.values.reserve(bytes.size() / 8);
  }

  Expected<JointTable> Run() {
    for (bool more = true; more;) {
      const std::size_t begin = table_.values.size();
      const int line = scanner_.line();
      line_begin_ = scanner_.rest();
      const Token token = scanner_.Numbers(table_.values);
      const std::size_t read = table_.values.size() - begin;
      const bool whole = token == Token::kLineEnd && read > 0 && read == static_cast<std::size_t>(table_.columns);
      if (whole && !TooLarge(begin)) {
        ++rows_;
        last_line_ = line;
        continue;
      }
      const Expected<Row> row = ReadRow(token, begin);
      if (!row) return Forward(row);
      more = row->more;
      if (row->numbers == 0 && row->damage.empty()) continue;  // a blank line
      if (Status kept = Keep(*row, begin, line); !kept) return Forward(kept);
    }
    return Finish();
  }

 private:
  struct Row {
    int numbers = 0;
    bool more = true;
    std::string damage;      ///< what is not a number; empty: nothing
    std::string not_finite;  ///< what is not finite, and was not declared; empty: nothing
    int not_finite_numbers = 0;
  };

  tl::unexpected<Error> Bad(std::string what, int line, std::string hint) const {
    return Fail(ErrorCode::kMalformed, std::move(what), name_ + ":" + std::to_string(line), std::move(hint));
  }

  std::string Column(int column) const {
    std::string number = "column " + std::to_string(column + 1);
    if (column >= static_cast<int>(layout_.column_names.size())) return number;
    return number + ", '" + layout_.column_names[static_cast<std::size_t>(column)] + "'";
  }

  /// The first column from `begin` on whose number is beyond the limit.
  std::optional<int> TooLarge(std::size_t begin) const {
    for (std::size_t at = begin; at < table_.values.size(); ++at) {
      if (std::abs(table_.values[at]) > kLargestNumber) return static_cast<int>(at - begin);
    }
    return std::nullopt;
  }

  /// The rest of a line whose numbers so far are stored from `begin` on, and end at `token`.
  Expected<Row> ReadRow(Token token, std::size_t begin) {
    Row row;
    for (;; token = scanner_.Numbers(table_.values)) {
      const bool first = table_.values.size() == begin;
      if (token == Token::kEnd || token == Token::kLineEnd) {
        row.more = token == Token::kLineEnd;
        row.numbers = static_cast<int>(table_.values.size() - begin);
        return row;
      }
      if (token == Token::kWord && first && !layout_.end_word.empty() && scanner_.text() == layout_.end_word) {
        if (Status closed = NothingFollows(); !closed) return Forward(closed);
        row.more = false;
        return row;
      }
      const bool nan = token == Token::kNotFinite;
      const bool declared = nan && layout_.allow_nan && IsNanWord(scanner_.text());
      if (nan && !declared) ++row.not_finite_numbers;
      std::string& place = nan ? row.not_finite : row.damage;
      if (place.empty() && !declared) {
        const int column = static_cast<int>(table_.values.size() - begin);
        place = "'" + Shown(scanner_.text()) + "' is not a " + (nan ? "finite number" : "number") + " (" +
                Column(column) + ")";
      }
      table_.values.push_back(kNan);
    }
  }

  Status NothingFollows() {
    for (Token token = scanner_.Next(); token != Token::kEnd; token = scanner_.Next()) {
      if (token == Token::kLineEnd) continue;
      return Bad("'" + Shown(scanner_.text()) + "' follows " + layout_.end_word, scanner_.line(),
                 layout_.end_word + " closes the table");
    }
    return {};
  }

  /// Counts the row. A damaged row is refused, or stored as NaN. Single numbers that are implausible are refused, or
  /// stored as NaN.
  Status Keep(const Row& row, std::size_t begin, int line) {
    const auto none = std::count_if(table_.values.begin() + static_cast<std::ptrdiff_t>(begin), table_.values.end(),
                                    [](double value) { return std::isnan(value); });
    const bool other_length = table_.columns > 0 && row.numbers != table_.columns;
    const bool words = none > 0 && (2 * none >= row.numbers || other_length);  // they may hold a number or two
    const std::string_view text = line_begin_.substr(0, line_begin_.find_first_of("\r\n"));
    const char other = OtherSeparator(text);
    if (rows_ == 0 && words && other == 0 && !row.damage.empty() && layout_.damaged_rows == DamagedRows::kReport &&
        ++header_lines_ <= kFewRows) {
      table_.values.resize(begin);
      AddFinding("not_a_number", 0, static_cast<double>(none),
                 name_ + ":" + std::to_string(line) + ": " + Counted(none, "word") +
                     " before the first row of numbers: a header");
      table_.findings.back().frame_end = 0;
      table_.findings.back().severity = Severity::kInfo;
      table_.findings.back().action = FindingAction::kExcluded;
      table_.header.push_back(HeaderCells(text));
      return {};
    }
    if (table_.columns == 0) table_.columns = row.numbers;
    std::string what = row.damage;
    std::string hint = "a joint table holds rows of numbers only, without a header";
    const char* code = "not_a_number";
    if (what.empty() && row.numbers != table_.columns) {
      code = "row_length";
      what = "row has " + Counted(row.numbers, "number") + ", not " + std::to_string(table_.columns);
      hint = "every row must have the declared columns; is the file cut off?";
    }
    const long long frame = rows_ / layout_.rows_per_frame;
    if (what.empty()) {
      if (Status kept = KeepNumbers(row, begin, line, frame); !kept) return kept;
    } else {
      if (other != 0) {
        what += std::string(": its numbers are separated by '") + other + "'";
        hint = "write them with blanks or commas between them";
        return Bad(what, line, hint);
      }
      if (layout_.damaged_rows == DamagedRows::kRefuse) return Bad(what, line, hint);
      if (first_damage_.empty()) first_damage_ = what, first_damaged_line_ = line;
      if (++damaged_rows_ > kFewRows && damaged_rows_ > rows_ / 2 + 1) {
        return Bad(first_damage_, first_damaged_line_,
                   "more rows are damaged than intact: this is not a table with the declared columns");
      }
      if (row.numbers < table_.columns) short_line_ = line;
      Report(code, frame, row.numbers, name_ + ":" + std::to_string(line) + ": " + what);
      table_.values.resize(begin + static_cast<std::size_t>(table_.columns), kNan);
      if (damaged_.empty() || damaged_.back() != frame) damaged_.push_back(frame);
    }
    last_line_ = line;
    ++rows_;
    return {};
  }

  /// Of a complete row: numbers that are not finite or implausibly large.
  Status KeepNumbers(const Row& row, std::size_t begin, int line, long long frame) {
    if (!row.not_finite.empty()) {
      constexpr const char* kWay = "if such a number means a missing joint, declare `missing: nan`";
      if (layout_.damaged_rows == DamagedRows::kRefuse) return Bad(row.not_finite, line, kWay);
      not_finite_.Add(row.not_finite_numbers, frame, line, row.not_finite);
    }
    const std::optional<int> first = TooLarge(begin);
    if (!first) return {};
    const std::string what = FormatDouble(table_.values[begin + static_cast<std::size_t>(*first)]) +
                             " is not a plausible coordinate (" + Column(*first) + ")";
    if (layout_.damaged_rows == DamagedRows::kRefuse) {
      return Bad(what, line, "the largest allowed number is " + FormatDouble(kLargestNumber));
    }
    int numbers = 0;
    for (auto value = table_.values.begin() + static_cast<std::ptrdiff_t>(begin); value != table_.values.end();
         ++value) {
      if (!(std::abs(*value) > kLargestNumber)) continue;
      *value = kNan;
      ++numbers;
    }
    too_large_.Add(numbers, frame, line, what);
    return {};
  }

  /// Numbers stored as NaN in complete rows: one finding for all.
  struct Excluded {
    long long numbers = 0;
    long long first_frame = 0;
    long long last_frame = 0;
    int first_line = 0;
    std::string first;

    void Add(int more, long long frame, int line, const std::string& what) {
      if (numbers == 0) {
        first_frame = frame;
        first_line = line;
        first = what;
      }
      numbers += more;
      last_frame = frame;
    }
  };

  void Report(const char* code, const Excluded& excluded, const std::string& way) {
    if (excluded.numbers == 0) return;
    AddFinding(code, excluded.first_frame, static_cast<double>(excluded.numbers),
               name_ + ":" + std::to_string(excluded.first_line) + ": " + excluded.first +
                   (excluded.numbers > 1 ? ", and " + Counted(excluded.numbers - 1, "more of these numbers") : "") +
                   "; a point with one of these numbers is set to missing" + way);
    table_.findings.back().frame_end =
        static_cast<int>(std::min<long long>(excluded.last_frame, std::numeric_limits<int>::max() - 1)) + 1;
    table_.findings.back().action = FindingAction::kMissing;
  }

  /// The first thousand damaged rows get a finding each.
  void Report(const char* code, long long frame, double value, std::string message) {
    constexpr std::size_t kMostFindings = 1000;
    if (table_.findings.size() >= kMostFindings) return;
    AddFinding(code, frame, value, std::move(message));
  }

  void AddFinding(const char* code, long long frame, double value, std::string message) {
    const int begin = static_cast<int>(std::min<long long>(frame, std::numeric_limits<int>::max() - 1));
    table_.findings.push_back(
        FindingOfFrames(code, begin, begin + 1, value, std::move(message), FindingAction::kDropped));
  }

  Expected<JointTable> Finish() {
    if (rows_ == 0 && !table_.findings.empty()) {
      return Fail(ErrorCode::kMalformed, "the file holds no row of numbers", name_, "this is not a table of numbers");
    }
    if (rows_ == 0) return Fail(ErrorCode::kMalformed, "the file holds no numbers", name_, "is the file empty?");
    const long long frames = rows_ / layout_.rows_per_frame;
    const long long left_over = rows_ % layout_.rows_per_frame;
    if (left_over != 0) {
      const std::string what = Counted(rows_, "row") + (rows_ == 1 ? " is" : " are") +
                               " not a whole number of frames of " + std::to_string(layout_.rows_per_frame) +
                               " rows (" + std::to_string(left_over) + " left over)";
      if (frames == 0 && !first_damage_.empty()) {
        return Bad(first_damage_, first_damaged_line_,
                   "no frame of the file is complete: this is not a table with the declared columns");
      }
      if (layout_.damaged_rows == DamagedRows::kRefuse || frames == 0) {
        return Bad(what, scanner_.line(),
                   "check rows_per_frame, and whether a row is missing, added or cut off at the end of the file");
      }
      AddFinding("cut_off", frames, static_cast<double>(left_over),
                 name_ + ":" + std::to_string(last_line_) + ": " + what);
      table_.findings.back().severity = Severity::kError;
    } else if (short_line_ == last_line_ && !table_.findings.empty()) {
      // A last row that is too short is where the file was cut.
      table_.findings.back().code = "cut_off";
      table_.findings.back().severity = Severity::kError;
    }
    if (frames > std::numeric_limits<int>::max()) return Fail(ErrorCode::kUnsupported, "too many frames", name_);
    Report("not_a_number", not_finite_, " (if it means a missing joint, declare `missing: nan`)");
    Report("number_too_large", too_large_, "");
    table_.frames = static_cast<int>(frames);
    const std::size_t size =
        static_cast<std::size_t>(layout_.rows_per_frame) * static_cast<std::size_t>(table_.columns);
    const auto whole = table_.values.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(frames) * size);
    table_.rows_left_over = static_cast<int>(left_over);
    table_.values.erase(whole, table_.values.end());
    for (const long long frame : damaged_) {
      if (frame < frames) std::fill_n(table_.values.begin() + static_cast<std::ptrdiff_t>(frame * size), size, kNan);
    }
    return std::move(table_);
  }

  const JointTableLayout& layout_;
  const std::string& name_;
  NumberScanner scanner_;
  std::string_view line_begin_;  ///< from the row that is read on
  JointTable table_;
  long long rows_ = 0;
  long long damaged_rows_ = 0;
  int last_line_ = 0;
  std::string first_damage_;  ///< of the first damaged row
  int first_damaged_line_ = 0;
  int header_lines_ = 0;
  int short_line_ = -1;  ///< the last one that had too few numbers
  std::vector<long long> damaged_;
  Excluded not_finite_;
  Excluded too_large_;
};

}  // namespace

std::vector<std::string> JointTable::names() const {
  if (header.empty()) return {};
  std::vector<std::string> last = header.back();
  if (static_cast<int>(last.size()) == columns + 1 && last.back().empty()) last.pop_back();  // behind a last separator
  return static_cast<int>(last.size()) == columns ? last : std::vector<std::string>();
}

Expected<JointTable> ParseJointTable(std::string_view bytes, const JointTableLayout& layout, const std::string& name) {
  if (bytes.substr(0, 2) == "\xFF\xFE" || bytes.substr(0, 2) == "\xFE\xFF") {
    return Fail(ErrorCode::kMalformed, "the text is UTF-16", name + ":1", "save it as UTF-8 or plain ASCII");
  }
  if (layout.rows_per_frame < 1) return Fail(ErrorCode::kUsage, "rows_per_frame must be at least 1", name);
  if (layout.damaged_rows == DamagedRows::kReport && layout.columns < 1) {
    return Fail(ErrorCode::kUsage, "damaged_rows: report needs declared columns", name);
  }
  return JointTableParser(bytes, layout, name).Run();
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
