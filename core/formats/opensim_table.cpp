#include "core/formats/opensim_table.h"

#include <set>
#include <utility>

#include "core/base/text.h"
#include "core/formats/file_rules.h"
#include "core/formats/joint_table.h"
#include "core/formats/line_reader.h"

namespace mocurate {
namespace {

class OpenSimParser {
 public:
  OpenSimParser(std::string_view bytes, const std::string& name) : lines_(bytes, name) {}

  Expected<OpenSimTable> Run() {
    if (lines_.Peek().empty()) return EmptyFile(lines_.name());
    if (Status read = Header(); !read) return Forward(read);
    if (Status read = Labels(); !read) return Forward(read);
    if (Status read = Rows(); !read) return Forward(read);
    return std::move(table_);
  }

 private:
  tl::unexpected<Error> Contradiction(const char* key, long long announced, long long found, int line) const {
    return CountContradiction(key, static_cast<double>(announced), static_cast<double>(found), lines_.Place(line));
  }

  Status Header() {
    for (bool first = true;; first = false) {
      const std::string_view line = lines_.Next();
      if (line.empty()) return lines_.CutOff("'endheader'");
      if (SameWord(line, "endheader")) return {};
      const std::size_t equals = line.find('=');
      const std::string_view key = Trim(line.substr(0, equals));
      const bool is_key = equals != std::string_view::npos && !key.empty() && SplitBlanks(key).size() == 1;
      if (is_key) {
        if (Status read = Key(key, Trim(line.substr(equals + 1))); !read) return read;
      } else if (first) {
        table_.title = std::string(line);
      }  // other lines are remarks
    }
  }

  Status Key(std::string_view key, std::string_view value) {
    const std::string called(key);
    if (!seen_.insert(called).second) return lines_.Bad("'" + Shown(key) + "' appears twice in the header");
    if (key == "nRows" || key == "nColumns") {
      const std::optional<long long> count = ParseInteger(value);
      if (!count || *count < 0) return lines_.Bad(called + " '" + Shown(value) + "' is not a count");
      (key == "nRows" ? rows_ : columns_) = std::make_pair(*count, lines_.number());
    } else if (key == "inDegrees") {
      if (value != "yes" && value != "no") return lines_.Bad("inDegrees is 'yes' or 'no', not '" + Shown(value) + "'");
      table_.in_degrees = value == "yes";
    } else if (key == "DataType") {
      table_.components = value == "double" ? 1 : value == "Vec3" ? 3 : value == "Quaternion" ? 4 : 0;
      if (table_.components == 0) {
        return Fail(ErrorCode::kUnsupported, "DataType '" + Shown(value) + "' is not read", lines_.Place(),
                    "double, Vec3 and Quaternion are");
      }
    } else {
      if (key == "version" && !ParseInteger(value)) return lines_.Bad("version '" + Shown(value) + "' is not a number");
      table_.header[called] = std::string(value);
    }
    return {};
  }

  Status Labels() {
    const std::string_view line = lines_.Next();
    if (line.empty()) return lines_.CutOff("the line of labels");
    const bool tabs = line.find('\t') != std::string_view::npos;
    std::set<std::string_view> seen;
    for (const std::string_view field : tabs ? SplitText(line, '\t') : SplitBlanks(line)) {
      const std::string_view label = Trim(field);
      if (label.empty()) return lines_.Bad("a label is empty: label " + std::to_string(seen.size() + 1));
      if (!seen.insert(label).second) return lines_.Bad("label '" + Shown(label) + "' appears twice");
      if (seen.size() == 1) {
        if (!SameWord(label, "time")) return lines_.Bad("the first label is 'time', not '" + Shown(label) + "'");
        continue;
      }
      table_.labels.emplace_back(label);
    }
    const long long count = static_cast<long long>(seen.size());
    if (columns_.second > 0 && columns_.first != count) {
      return Contradiction("nColumns", columns_.first, count, columns_.second);
    }
    if (table_.labels.empty()) return lines_.Bad("the file has no column but time");
    return {};
  }

  Status Rows() {
    JointTableLayout layout;
    layout.first_line = lines_.number() + 1;
    layout.columns = 1 + static_cast<int>(table_.labels.size()) * table_.components;
    layout.separator = table_.components > 1 ? JointTableLayout::Separator::kAny : JointTableLayout::Separator::kBlanks;
    layout.column_names.push_back("time");
    for (const std::string& label : table_.labels) {
      for (int c = 0; c < table_.components; ++c) layout.column_names.push_back(Shown(label));
    }
    const Expected<JointTable> read = ParseJointTable(lines_.rest(), layout, lines_.name());
    if (!read) return Forward(read);
    if (rows_.second > 0 && rows_.first != read->frames) {
      return Contradiction("nRows", rows_.first, read->frames, rows_.second);
    }
    for (int row = 0; row < read->frames; ++row) {
      const auto begin = read->values.begin() + static_cast<std::ptrdiff_t>(row) * layout.columns;
      if (!table_.time_s.empty() && !(*begin > table_.time_s.back())) {
        return Fail(ErrorCode::kMalformed,
                    "time " + FormatDouble(*begin) + " in row " + std::to_string(row) + " does not come after " +
                        FormatDouble(table_.time_s.back()),
                    lines_.name() + ":" + std::to_string(layout.first_line + row), "rows must be in the order of time");
      }
      table_.time_s.push_back(*begin);
      table_.values.insert(table_.values.end(), begin + 1, begin + layout.columns);
    }
    return {};
  }

  LineReader lines_;
  OpenSimTable table_;
  std::set<std::string> seen_;
  std::pair<long long, int> rows_{0, 0}, columns_{0, 0};  ///< count and line; line 0: not declared
};

}  // namespace

Expected<OpenSimTable> ParseOpenSimTable(std::string_view bytes, const std::string& name) {
  return OpenSimParser(bytes, name).Run();
}

}  // namespace mocurate
