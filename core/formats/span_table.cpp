#include "core/formats/span_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/table_text.h"
#include "core/base/text.h"
#include "core/formats/line_reader.h"
#include "core/formats/phspd_text.h"

namespace mocurate {
namespace {

/// An action code of HumanAct12, as the paper's Table 5 names it (a2m_actor.md A.1; 0802 is the left hand and 0803 the
/// pie: an enumerator in the published code exchanges the two).
struct HumanAct12Code {
  const char* code;   ///< four digits: coarse, fine
  const char* label;  ///< of the coarse class
  const char* fine_label;
};

constexpr std::array<HumanAct12Code, 34> kCodes = {{
    {"0101", "warm_up", "warm_up_wrist_ankle"},
    {"0102", "warm_up", "warm_up_pectoral"},
    {"0103", "warm_up", "warm_up_elbow_back"},
    {"0104", "warm_up", "warm_up_body_lean_right_arm"},
    {"0105", "warm_up", "warm_up_body_lean_left_arm"},
    {"0106", "warm_up", "warm_up_bow_right"},
    {"0107", "warm_up", "warm_up_bow_left"},
    {"0201", "walk", "walk"},
    {"0301", "run", "run"},
    {"0401", "jump", "jump_hands_up"},
    {"0402", "jump", "jump_vertical"},
    {"0501", "drink", "drink_bottle_right_hand"},
    {"0502", "drink", "drink_bottle_left_hand"},
    {"0503", "drink", "drink_cup_right_hand"},
    {"0504", "drink", "drink_cup_left_hand"},
    {"0505", "drink", "drink_both_hands"},
    {"0601", "lift_dumbbell", "lift_dumbbell_right_hand"},
    {"0602", "lift_dumbbell", "lift_dumbbell_left_hand"},
    {"0603", "lift_dumbbell", "lift_dumbbell_both_hands"},
    {"0604", "lift_dumbbell", "lift_dumbbell_overhead"},
    {"0605", "lift_dumbbell", "lift_dumbbell_both_hands_bend_legs"},
    {"0701", "sit", "sit"},
    {"0801", "eat", "eat_right_hand"},
    {"0802", "eat", "eat_left_hand"},
    {"0803", "eat", "eat_pie_burger"},
    {"0901", "turn_steering_wheel", "turn_steering_wheel"},
    {"1001", "phone", "phone_take_out_call_put_back"},
    {"1002", "phone", "phone_call_left_hand"},
    {"1101", "boxing", "boxing_left_right"},
    {"1102", "boxing", "boxing_left_upwards"},
    {"1103", "boxing", "boxing_right_upwards"},
    {"1104", "boxing", "boxing_right_left"},
    {"1201", "throw", "throw_right_hand"},
    {"1202", "throw", "throw_both_hands"},
}};

/// A number of `digits` digits after the letter `tag` (none where it is 0), taken off the front of the text.
std::optional<int> TakeDigits(char tag, std::size_t digits, std::string_view& text) {
  if (tag != 0) {
    if (text.empty() || text[0] != tag) return std::nullopt;
    text.remove_prefix(1);
  }
  const std::string_view part = text.substr(0, digits);
  const bool whole =
      part.size() == digits && std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!whole) return std::nullopt;
  text.remove_prefix(digits);
  return static_cast<int>(*ParseInteger(part));
}

/// A clip's name: what it was cut from, first and last frame (both included), action.
struct HumanAct12Name {
  PhspdRecording recording;
  int first = 0;
  int last = 0;
  std::string code;
};

/// Null for an unknown code.
const HumanAct12Code* FindHumanAct12Code(std::string_view code) {
  const auto* found =
      std::find_if(kCodes.begin(), kCodes.end(), [&](const HumanAct12Code& entry) { return entry.code == code; });
  return found == kCodes.end() ? nullptr : found;
}

/// "P01G01R01F0001T0064A0101", with or without ".npy", or its digits alone, "0111000100640101" (group and repetition
/// without their leading 0). Empty where the text is not such a name.
std::optional<HumanAct12Name> ParseHumanAct12Name(std::string_view text) {
  const bool tagged = !text.empty() && text[0] == 'P';
  const std::size_t width = tagged ? 2 : 1;  // of group and repetition
  const auto tag = [&](char letter) { return tagged ? letter : '\0'; };
  HumanAct12Name name;
  const auto subject = TakeDigits(tag('P'), 2, text);
  const auto group = subject ? TakeDigits(tag('G'), width, text) : std::nullopt;
  const auto time = group ? TakeDigits(tag('R'), width, text) : std::nullopt;
  const auto first = time ? TakeDigits(tag('F'), 4, text) : std::nullopt;
  const auto last = first ? TakeDigits(tag('T'), 4, text) : std::nullopt;
  if (!last) return std::nullopt;
  const std::string_view action = text;
  if (!TakeDigits(tag('A'), 4, text)) return std::nullopt;
  name.code = action.substr(tagged ? 1 : 0, 4);
  if (!text.empty() && !(tagged && text == ".npy")) return std::nullopt;
  name.recording = {*subject, *group, *time};
  name.first = *first;
  name.last = *last;
  return name;
}

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
