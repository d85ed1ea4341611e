#include "core/formats/span_table.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/table_text.h"
#include "core/base/text.h"
#include "core/formats/humanact12_names.h"
#include "core/formats/line_reader.h"

namespace mocurate {
namespace {

/// The position of each column; -1: absent.
struct SpanColumns {
  std::ptrdiff_t clip = -1, begin = -1, end = -1, label = -1, fine_label = -1;
  bool in_frames = false;
  std::size_t count = 0;
};

std::optional<SpanColumns> ColumnsOfHeader(const std::vector<std::string>& header) {
  const auto at = [&](std::string_view name) {
    const auto found = std::find(header.begin(), header.end(), name);
    return found == header.end() ? -1 : found - header.begin();
  };
  SpanColumns columns{at("clip"), at("begin_s"), at("end_s"), at("label"), at("fine_label"), false, header.size()};
  if (columns.begin < 0 && columns.end < 0) {
    columns.begin = at("begin_frame");
    columns.end = at("end_frame");
    columns.in_frames = true;
  }
  if (columns.clip < 0 || columns.begin < 0 || columns.end < 0 || columns.label < 0) return std::nullopt;
  return columns;
}

constexpr const char* kHeaderHint =
    "begin the table with clip,begin_s,end_s,label (or begin_frame, end_frame), or write one HumanAct12 name a line";

Expected<ListedSpan> SpanOfRow(const SpanColumns& columns, std::string_view line, const LineReader& reader) {
  const auto cells = CellsOfCsvLine(line);
  if (!cells) return reader.Bad("a quote is not closed");
  if (cells->size() != columns.count) {
    return reader.Bad(
        Counted(static_cast<long long>(cells->size()), "cell") + ", the header has " + std::to_string(columns.count),
        "separate cells by commas; put a cell that holds a comma in quotes");
  }
  const auto cell = [&](std::ptrdiff_t column) { return (*cells)[static_cast<std::size_t>(column)]; };
  ListedSpan span;
  span.clip = cell(columns.clip);
  span.label = cell(columns.label);
  if (columns.fine_label >= 0) span.fine_label = cell(columns.fine_label);
  span.in_frames = columns.in_frames;
  span.line = reader.number();
  span.place = reader.Place();
  const auto begin = ParseDouble(cell(columns.begin)), end = ParseDouble(cell(columns.end));
  if (span.clip.empty()) return reader.Bad("the row names no clip", "write source/person/recording, or its recording");
  if (span.label.empty()) return reader.Bad("the row has no label", "name the activity of the span, or remove the row");
  for (const auto& [number, column] : {std::pair(begin, columns.begin), std::pair(end, columns.end)}) {
    if (number && std::isfinite(*number)) continue;
    return reader.Bad("'" + Shown(cell(column)) + "' is not a number", columns.in_frames
                                                                           ? "frames are whole numbers, counted from 0"
                                                                           : "seconds are numbers such as 12.5");
  }
  const bool whole = *begin == std::floor(*begin) && *end == std::floor(*end);
  if (columns.in_frames && (!whole || *end > 1e9)) {
    return reader.Bad(FormatDouble(*begin) + " to " + FormatDouble(*end) + " are not frame numbers",
                      "frames are whole numbers");
  }
  if (*begin < 0.0 || *begin >= *end || *end > 1e9) {
    return reader.Bad("the span from " + FormatDouble(*begin) + " to " + FormatDouble(*end) +
                          (*begin >= *end ? " is empty or reversed" : " begins before the recording"),
                      "a span begins at 0 or later and ends after its begin");
  }
  span.begin = *begin;
  span.end = *end;
  return span;
}

Expected<ListedSpan> SpanOfName(std::string_view line, const LineReader& reader) {
  const auto name = ParseHumanAct12Name(line);
  if (!name) return reader.Bad("'" + Shown(line) + "' is not a clip name of HumanAct12", kHeaderHint);
  const HumanAct12Code* code = FindHumanAct12Code(name->code);
  if (code == nullptr) return reader.Bad("HumanAct12 has no action code " + name->code);
  if (name->last < name->first) {
    return reader.Bad("the last frame, " + std::to_string(name->last) + ", comes before the first, " +
                      std::to_string(name->first));
  }
  ListedSpan span;
  span.clip = name->recording.Name();
  span.begin = name->first;
  span.end = name->last + 1.0;
  span.in_frames = true;
  span.label = code->label;
  span.fine_label = code->fine_label;
  span.line = reader.number();
  span.place = reader.Place();
  return span;
}

}  // namespace

Expected<std::vector<ListedSpan>> ParseSpanTable(std::string_view bytes, const std::string& name) {
  LineReader reader(bytes, name);
  std::vector<ListedSpan> spans;
  std::optional<SpanColumns> columns;
  for (std::string_view line = reader.Next(); !line.empty(); line = reader.Next()) {
    if (line[0] == '#') continue;
    if (!columns && spans.empty() && line.find_first_of(",;\t") != std::string_view::npos) {
      const auto header = CellsOfCsvLine(line);
      if (header) columns = ColumnsOfHeader(*header);
      if (!columns) return reader.Bad("'" + Shown(line) + "' is not a header of a table of spans", kHeaderHint);
      continue;
    }
    Expected<ListedSpan> span = columns ? SpanOfRow(*columns, line, reader) : SpanOfName(line, reader);
    if (!span) return Forward(span);
    spans.push_back(*std::move(span));
  }
  if (spans.empty() && !columns) {
    return Fail(ErrorCode::kMalformed, "the file holds no table of spans and no name", name, kHeaderHint);
  }
  return spans;
}

}  // namespace mocurate
