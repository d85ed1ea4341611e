#include "core/formats/joint_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/text.h"
#include "core/formats/line_reader.h"
#include "core/formats/row_counter.h"

namespace mocurate {
namespace {

constexpr int kMostNumbers = 100000;  // of one frame
constexpr std::array<const char*, 13> kWords = {
    "x",       "y",       "z",          "confidence", "rotation", "rotation_confidence", "frame", "time_s",
    "time_ms", "time_us", "time_100ns", "time_ns",    "skip"};

int Width(JointColumn column) { return column == JointColumn::kRotation ? 9 : 1; }

int Width(const JointGroup& group) {
  int width = 0;
  for (const JointColumn column : group.columns) width += Width(column);
  return width;
}

bool Has(const JointGroup& group, JointColumn column) {
  return std::find(group.columns.begin(), group.columns.end(), column) != group.columns.end();
}

bool IsTime(JointColumn column) { return column >= JointColumn::kTimeS && column <= JointColumn::kTimeNs; }
bool IsCounter(JointColumn column) { return column == JointColumn::kFrame || IsTime(column); }

const ClockUnit& UnitOfTime(JointColumn column) {
  return ClockUnits()[static_cast<std::size_t>(column) - static_cast<std::size_t>(JointColumn::kTimeS)];
}

bool Has(const JointLayout& layout, JointColumn column) {
  return std::any_of(layout.groups.begin(), layout.groups.end(),
                     [column](const JointGroup& group) { return Has(group, column); });
}

std::vector<std::string> Tokens(std::string_view text) {
  std::vector<std::string> tokens;
  bool in_word = false;
  for (const char c : text) {
    const bool blank = c == ' ' || c == '\t' || c == '\n' || c == ',';
    const bool sign = c == '(' || c == ')' || c == '*';
    if (sign) tokens.emplace_back(1, c);
    if (!blank && !sign) {
      if (!in_word) tokens.emplace_back();
      tokens.back() += c;
    }
    in_word = !blank && !sign;
  }
  return tokens;
}

Expected<JointColumn> ColumnOf(const std::string& word, const std::string& where) {
  for (std::size_t i = 0; i < kWords.size(); ++i) {
    if (word == kWords[i]) return static_cast<JointColumn>(i);
  }
  const std::vector<std::string> words(kWords.begin(), kWords.end());
  return Fail(ErrorCode::kConfig, "'" + Shown(word) + "' is not a column of a joint", where,
              DidYouMean(word, words, "columns are " + JoinTexts(words, " ")));
}

Status CheckGroup(const JointGroup& group, const std::string& where) {
  const int coordinates = static_cast<int>(Has(group, JointColumn::kX)) +
                          static_cast<int>(Has(group, JointColumn::kY)) + static_cast<int>(Has(group, JointColumn::kZ));
  if (group.columns.empty()) return Fail(ErrorCode::kConfig, "a group of joints has no columns", where);
  if (coordinates != 0 && coordinates != 3) {
    return Fail(ErrorCode::kConfig, "a joint needs all of x, y and z", where);
  }
  for (const JointColumn column : group.columns) {
    const bool repeats = std::count(group.columns.begin(), group.columns.end(), column) > 1;
    if (repeats && column != JointColumn::kSkip) {
      return Fail(ErrorCode::kConfig,
                  std::string("a joint has '") + kWords[static_cast<std::size_t>(column)] + "' twice", where);
    }
    const bool of_joint = !IsCounter(column) && column != JointColumn::kSkip;
    if (of_joint && coordinates == 0) {
      return Fail(ErrorCode::kConfig,
                  std::string("'") + kWords[static_cast<std::size_t>(column)] + "' is in a group without x, y, z",
                  where);
    }
    if (IsCounter(column) && coordinates == 0 && group.count != 1) {
      return Fail(ErrorCode::kConfig,
                  std::string("'") + kWords[static_cast<std::size_t>(column)] + "' appears once outside of the joints",
                  where);
    }
  }
  return {};
}

/// Names of the columns of one row, for messages: "joint 3 x", or "x" where each joint has its own row.
std::vector<std::string> ColumnNames(const JointLayout& layout, int columns) {
  std::vector<std::string> names;
  const bool one_row = columns == layout.NumbersPerFrame();
  int joint = 0;
  for (const JointGroup& group : layout.groups) {
    for (int i = 0; i < group.count; ++i) {
      const std::string owner = one_row && group.IsJoint() ? "joint " + std::to_string(joint) + " " : "";
      for (const JointColumn column : group.columns) {
        for (int k = 0; k < Width(column); ++k) {
          if (static_cast<int>(names.size()) == columns) return names;
          names.push_back(owner + kWords[static_cast<std::size_t>(column)]);
        }
      }
      if (group.IsJoint()) ++joint;
    }
  }
  return names;
}

/// Where the numbers of one frame go. False where its joints repeat the frame's number or time, and it differs.
bool PlaceFrame(const JointLayout& layout, const double* from, int frame, JointRows& rows) {
  std::size_t joint = static_cast<std::size_t>(frame) * static_cast<std::size_t>(rows.joints);
  bool one = true, counted = false;
  const auto count = [&](double number) {
    double& counter = rows.counter[static_cast<std::size_t>(frame)];
    one = one && (!counted || number == counter || std::isnan(number) || std::isnan(counter));
    counter = number;
    counted = true;
  };
  for (const JointGroup& group : layout.groups) {
    for (int i = 0; i < group.count; ++i) {
      for (const JointColumn column : group.columns) {
        switch (column) {
          case JointColumn::kX:
          case JointColumn::kY:
          case JointColumn::kZ:
            rows.position[joint * 3 + static_cast<std::size_t>(column)] = *from;
            break;
          case JointColumn::kConfidence:
            rows.confidence[joint] = *from;
            break;
          case JointColumn::kRotation:
            std::copy_n(from, 9, rows.rotation.begin() + static_cast<std::ptrdiff_t>(joint * 9));
            break;
          case JointColumn::kRotationConfidence:
            rows.rotation_confidence[joint] = *from;
            break;
          case JointColumn::kFrame:
          case JointColumn::kTimeS:
          case JointColumn::kTimeMs:
          case JointColumn::kTimeUs:
          case JointColumn::kTime100ns:
          case JointColumn::kTimeNs:
            count(*from);
            break;
          case JointColumn::kSkip:
            break;
        }
        from += Width(column);
      }
      if (group.IsJoint()) ++joint;
    }
  }
  return one;
}

void CheckFrameNumbers(JointRows& rows, const std::string& name) {
  for (std::size_t f = 1; f < rows.counter.size(); ++f) {
    const double number = rows.counter[f], before = rows.counter[f - 1];
    if (std::isnan(number) || std::isnan(before) || number == before + 1.0) continue;
    rows.findings.push_back(FindingOfFrames(
        "frame_number", static_cast<int>(f), static_cast<int>(f) + 1, number,
        name + ": frame number " + FormatDouble(number) + " follows " + FormatDouble(before), FindingAction::kKept));
    return;  // the first one is enough: what follows may all be shifted
  }
}

/// (frames, width) values of rows at their places among `frames`, NaN between.
void Spread(const std::vector<int>& places, int frames, std::vector<double>& values) {
  if (values.empty()) return;
  const std::size_t width = values.size() / places.size();
  std::vector<double> spread(static_cast<std::size_t>(frames) * width, std::nan(""));
  for (std::size_t f = 0; f < places.size(); ++f) {
    if (places[f] < 0) continue;
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(f * width), width,
                spread.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(places[f]) * width));
  }
  values = std::move(spread);
}

/// Rows that stand at the time of the one before hold the same moment again.
void ReportStillRows(const RowPlaces& places, const std::string& name, JointRows& rows) {
  const auto still = std::count(places.place.begin(), places.place.end(), -1);
  if (still == 0) return;
  const auto first = std::find(places.place.begin(), places.place.end(), -1);
  const auto row = static_cast<std::size_t>(first - places.place.begin());
  const int frame = places.place[row - 1];
  rows.findings.push_back(FindingOfFrames("frame_number", frame, frame + 1, static_cast<double>(still),
                                          name + ": " + Counted(still, "row") + (still == 1 ? " stands" : " stand") +
                                              " at the time of the row before; the first is row " +
                                              std::to_string(row + 1) + ", " + FormatDouble(rows.counter[row]) +
                                              ": not used",
                                          FindingAction::kDropped));
}

/// Inserts missing frames for skipped numbers or times, so that later frames keep their time.
void KeepGaps(const RowPlaces& places, const std::string& name, JointRows& rows) {
  MoveFindings(places, rows.findings);
  ReportStillRows(places, name, rows);
  std::size_t before = 0;
  for (std::size_t f = 1; f < places.place.size(); ++f) {
    if (places.place[f] < 0) continue;
    const int skipped = places.place[f] - places.place[before] - 1;
    if (skipped > 0) {
      rows.findings.push_back(FindingOfFrames("time_gap", places.place[before] + 1, places.place[f], skipped,
                                              Counted(skipped, "frame") +
                                                  " without a row: " + FormatDouble(rows.counter[before]) +
                                                  " is followed by " + FormatDouble(rows.counter[f]),
                                              FindingAction::kDropped));
    }
    before = f;
  }
  rows.frames = places.frames();
  for (std::vector<double>* values :
       {&rows.position, &rows.confidence, &rows.rotation, &rows.rotation_confidence, &rows.counter})
    Spread(places.place, rows.frames, *values);
}

/// The first column of a frame that counts it; -1: none.
int CounterColumn(const JointLayout& layout) {
  int at = 0;
  for (const JointGroup& group : layout.groups) {
    for (const JointColumn column : group.columns) {
      if (IsCounter(column)) return at;
      at += Width(column);
    }
    at += (group.count - 1) * Width(group);
  }
  return -1;
}

/// Refuses a clock that is declared to count frames, and a time in another unit than the header names.
Status CheckCounter(const JointRows& rows, JointColumn column, const std::string& header, double rate_hz,
                    const std::string& name) {
  const CounterName named = CounterNameOf(header);
  const std::string called = header.empty() ? "" : ", '" + Shown(header) + "' in the header,";
  if (IsTime(column)) {
    const ClockUnit& unit = UnitOfTime(column);
    if (named.unit == nullptr || named.unit->seconds == unit.seconds) return {};
    return Fail(ErrorCode::kInconsistent,
                "the column of times" + called + " is declared in " + unit.name + ", but named in " + named.unit->name,
                name, std::string("declare time_") + named.unit->name);
  }
  const CounterEstimate estimate = EstimateCounter(rows.counter, named);
  if (!IsClock(estimate, named, rate_hz)) return {};
  const std::string unit = estimate.units.size() == 1 ? estimate.units[0].name : "ms";
  return Fail(ErrorCode::kInconsistent,
              "the column declared as `frame`" + called + " is a clock, by its " + estimate.words, name,
              "declare it as a time in its unit, e.g. time_" + unit + ", or as `skip` where rows follow one another");
}

/// Lays the rows out by their numbers or times.
Status LayOut(const JointLayout& layout, const std::vector<std::string>& header, double rate_hz,
              const std::string& name, JointRows& rows) {
  const JointColumn column = layout.Counter();
  if (column == JointColumn::kSkip) return {};
  const auto at = static_cast<std::size_t>(CounterColumn(layout));
  const std::string called = at < header.size() ? header[at] : "";
  if (Status counter = CheckCounter(rows, column, called, rate_hz, name); !counter) return counter;
  const Expected<RowPlaces> places =
      IsTime(column) ? PlacesByClock(rows.counter, name) : PlacesByNumber(rows.counter, 1.0, name);
  if (!places) return Forward(places);
  if (places->step > 0.0) rows.hz = 1.0 / (places->step * UnitOfTime(column).seconds);
  const bool gaps = !places->place.empty() && places->frames() > rows.frames;
  const bool still = std::count(places->place.begin(), places->place.end(), -1) > 0;
  if (gaps || still) KeepGaps(*places, name, rows);
  if (column == JointColumn::kFrame) CheckFrameNumbers(rows, name);
  return {};
}

}  // namespace

bool JointGroup::IsJoint() const { return Has(*this, JointColumn::kX); }

int JointLayout::Joints() const {
  int joints = 0;
  for (const JointGroup& group : groups) joints += group.IsJoint() ? group.count : 0;
  return joints;
}

JointColumn JointLayout::Counter() const {
  for (const JointGroup& group : groups) {
    const auto counter = std::find_if(group.columns.begin(), group.columns.end(), IsCounter);
    if (counter != group.columns.end()) return *counter;
  }
  return JointColumn::kSkip;
}

bool JointLayout::has_time() const { return IsTime(Counter()); }

int JointLayout::NumbersPerFrame() const {
  int numbers = 0;
  for (const JointGroup& group : groups) numbers += group.count * Width(group);
  return numbers;
}

Expected<JointLayout> ParseJointLayout(std::string_view text, const std::string& where) {
  const std::vector<std::string> tokens = Tokens(text);
  JointLayout layout;
  long long numbers = 0;
  int counters = 0;
  for (std::size_t at = 0; at < tokens.size();) {
    JointGroup group;
    if (const std::optional<long long> count = ParseInteger(tokens[at])) {
      if (*count < 1 || *count > kMostNumbers) {
        return Fail(ErrorCode::kConfig, "a group of " + tokens[at] + " joints", where, "at least one");
      }
      group.count = static_cast<int>(*count);
      if (at + 2 >= tokens.size() || tokens[at + 1] != "*" || tokens[at + 2] != "(") {
        return Fail(ErrorCode::kConfig, "'*(' is expected after " + tokens[at], where, "as in 15*(x y z)");
      }
      for (at += 3; at < tokens.size() && tokens[at] != ")"; ++at) {
        const Expected<JointColumn> column = ColumnOf(tokens[at], where);
        if (!column) return Forward(column);
        group.columns.push_back(*column);
      }
      if (at == tokens.size()) return Fail(ErrorCode::kConfig, "a bracket is not closed", where, "as in 15*(x y z)");
    } else {
      const Expected<JointColumn> column = ColumnOf(tokens[at], where);
      if (!column) return Forward(column);
      group.columns.push_back(*column);
    }
    ++at;
    if (Status checked = CheckGroup(group, where); !checked) return Forward(checked);
    if (std::any_of(group.columns.begin(), group.columns.end(), IsCounter)) ++counters;
    numbers += static_cast<long long>(group.count) * Width(group);
    if (numbers > kMostNumbers) return Fail(ErrorCode::kConfig, "a frame of more than 100000 numbers", where);
    layout.groups.push_back(std::move(group));
  }
  if (layout.Joints() == 0) return Fail(ErrorCode::kConfig, "the layout has no joint", where, "as in 15*(x y z)");
  if (counters > 1) {
    return Fail(ErrorCode::kConfig, "the layout counts the frames in several columns", where,
                "declare one of them as `frame` or a time, and the others as `skip`");
  }
  return layout;
}

Expected<JointRows> RowsOf(const JointTable& table, const JointLayout& layout, const std::string& name) {
  const auto numbers = static_cast<std::size_t>(layout.NumbersPerFrame());
  const std::size_t frames = table.values.size() / numbers;
  JointRows rows;
  rows.frames = static_cast<int>(frames);
  rows.joints = layout.Joints();
  const std::size_t joints = frames * static_cast<std::size_t>(rows.joints);
  rows.position.resize(joints * 3);
  if (Has(layout, JointColumn::kConfidence)) rows.confidence.resize(joints, 1.0);
  if (Has(layout, JointColumn::kRotation)) rows.rotation.resize(joints * 9);
  if (Has(layout, JointColumn::kRotationConfidence)) rows.rotation_confidence.resize(joints);
  if (layout.Counter() != JointColumn::kSkip) rows.counter.resize(frames);
  for (int f = 0; f < rows.frames; ++f) {
    if (PlaceFrame(layout, &table.values[static_cast<std::size_t>(f) * numbers], f, rows)) continue;
    return Fail(ErrorCode::kInconsistent,
                "the rows of frame " + std::to_string(f) + " repeat different numbers or times of it", name,
                "a row is lost or repeated: compare the file with its source, or correct rows_per_frame");
  }
  return rows;
}

Expected<JointRows> ParseJointRows(std::string_view bytes, const JointLayout& layout, JointTableLayout table,
                                   const std::string& name, double rate_hz) {
  const int numbers = layout.NumbersPerFrame();
  if (table.rows_per_frame < 1 || numbers < 1 || numbers % table.rows_per_frame != 0) {
    return Fail(ErrorCode::kUsage,
                std::to_string(numbers) + " numbers of a frame do not fill " + std::to_string(table.rows_per_frame) +
                    " rows evenly",
                name);
  }
  table.columns = numbers / table.rows_per_frame;
  table.column_names = ColumnNames(layout, table.columns);
  Expected<JointTable> read = ParseJointTable(bytes, table, name);
  if (!read) return Forward(read);
  Expected<JointRows> rows = RowsOf(*read, layout, name);
  if (!rows) return rows;
  rows->rows_left_over = read->rows_left_over;
  rows->findings = std::move(read->findings);
  rows->header = read->header;
  if (Status laid = LayOut(layout, read->names(), rate_hz, name, *rows); !laid) return Forward(laid);
  return rows;
}

}  // namespace mocurate
