#include "core/formats/joint_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/text.h"
#include "core/formats/line_reader.h"

namespace mocurate {
namespace {

constexpr int kMostNumbers = 100000;  // of one frame
constexpr std::array<const char*, 8> kWords = {"x",     "y",   "z", "confidence", "rotation", "rotation_confidence",
                                               "frame", "skip"};

int Width(JointColumn column) { return column == JointColumn::kRotation ? 9 : 1; }

int Width(const JointGroup& group) {
  int width = 0;
  for (const JointColumn column : group.columns) width += Width(column);
  return width;
}

bool Has(const JointGroup& group, JointColumn column) {
  return std::find(group.columns.begin(), group.columns.end(), column) != group.columns.end();
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
  const auto nearest = Nearest(word, std::vector<std::string>(kWords.begin(), kWords.end()));
  return Fail(ErrorCode::kConfig, "'" + Shown(word) + "' is not a column of a joint", where,
              nearest ? "did you mean '" + *nearest + "'?"
                      : "columns are x y z confidence rotation rotation_confidence frame skip");
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
    const bool of_joint = column != JointColumn::kFrame && column != JointColumn::kSkip;
    if (of_joint && coordinates == 0) {
      return Fail(ErrorCode::kConfig,
                  std::string("'") + kWords[static_cast<std::size_t>(column)] + "' is in a group without x, y, z",
                  where);
    }
    if (column == JointColumn::kFrame && (coordinates != 0 || group.count != 1)) {
      return Fail(ErrorCode::kConfig, "'frame' appears once, outside of the joints", where);
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

/// Where the numbers of one frame go.
void PlaceFrame(const JointLayout& layout, const double* from, int frame, JointRows& rows) {
  std::size_t joint = static_cast<std::size_t>(frame) * static_cast<std::size_t>(rows.joints);
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
            rows.frame_number[static_cast<std::size_t>(frame)] = *from;
            break;
          case JointColumn::kSkip:
            break;
        }
        from += Width(column);
      }
      if (group.IsJoint()) ++joint;
    }
  }
}

void CheckFrameNumbers(JointRows& rows, const std::string& name) {
  for (std::size_t f = 1; f < rows.frame_number.size(); ++f) {
    const double number = rows.frame_number[f], before = rows.frame_number[f - 1];
    if (std::isnan(number) || std::isnan(before) || number == before + 1.0) continue;
    Finding finding;
    finding.code = "frame_number";
    finding.frame_begin = static_cast<int>(f);
    finding.frame_end = static_cast<int>(f) + 1;
    finding.value = number;
    finding.message = name + ": frame number " + FormatDouble(number) + " follows " + FormatDouble(before);
    finding.action = FindingAction::kKept;
    rows.findings.push_back(std::move(finding));
    return;  // the first one is enough: what follows may all be shifted
  }
}

/// The frame index of each row by its frame number. Empty where no number is skipped, where the numbers do not grow by
/// whole steps, or where more are skipped than a recording would lose.
std::vector<int> PlacesByNumber(const JointRows& rows) {
  constexpr double kLongestGap = 10000.0;  // frames; a recording of minutes has some thousands
  std::vector<int> places;
  if (rows.frame_number.empty() || std::isnan(rows.frame_number[0])) return places;  // damaged: nothing to count from
  double last = 0.0;
  for (std::size_t f = 0; f < rows.frame_number.size(); ++f) {
    const double number = std::isnan(rows.frame_number[f]) ? last + 1.0 : rows.frame_number[f];  // of a damaged row
    const double step = f == 0 ? 1.0 : number - last;
    if (!(step >= 1.0) || step != std::floor(step) || step > kLongestGap) return {};
    places.push_back(f == 0 ? 0 : places.back() + static_cast<int>(step));
    if (places.back() >= rows.frames + static_cast<int>(kLongestGap)) return {};
    last = number;
  }
  const bool gaps = !places.empty() && places.back() + 1 > rows.frames;
  return gaps ? places : std::vector<int>();
}

/// (frames, width) values of rows at their places among `frames`, NaN between.
void Spread(const std::vector<int>& places, int frames, std::vector<double>& values) {
  if (values.empty()) return;
  const std::size_t width = values.size() / places.size();
  std::vector<double> spread(static_cast<std::size_t>(frames) * width, std::nan(""));
  for (std::size_t f = 0; f < places.size(); ++f) {
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(f * width), width,
                spread.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(places[f]) * width));
  }
  values = std::move(spread);
}

/// Inserts missing frames for skipped frame numbers, so that later frames keep their time.
void KeepGaps(JointRows& rows) {
  const std::vector<int> places = PlacesByNumber(rows);
  if (places.empty()) return;
  const auto placed = [&](int frame) {
    return frame < static_cast<int>(places.size()) ? places[static_cast<std::size_t>(frame)] : places.back() + 1;
  };
  for (Finding& finding : rows.findings) {
    const bool any = finding.frame_end > finding.frame_begin;
    finding.frame_begin = placed(finding.frame_begin);
    finding.frame_end = any ? placed(finding.frame_end - 1) + 1 : finding.frame_begin;
  }
  for (std::size_t f = 1; f < places.size(); ++f) {
    const int skipped = places[f] - places[f - 1] - 1;
    if (skipped == 0) continue;
    Finding finding;
    finding.code = "time_gap";
    finding.frame_begin = places[f - 1] + 1;
    finding.frame_end = places[f];
    finding.value = skipped;
    finding.message = Counted(skipped, "frame") + " without a row: " + FormatDouble(rows.frame_number[f - 1]) +
                      " is followed by " + FormatDouble(rows.frame_number[f]);
    finding.action = FindingAction::kDropped;
    rows.findings.push_back(std::move(finding));
  }
  rows.frames = places.back() + 1;
  for (std::vector<double>* values :
       {&rows.position, &rows.confidence, &rows.rotation, &rows.rotation_confidence, &rows.frame_number})
    Spread(places, rows.frames, *values);
}

}  // namespace

bool JointGroup::IsJoint() const { return Has(*this, JointColumn::kX); }

int JointLayout::Joints() const {
  int joints = 0;
  for (const JointGroup& group : groups) joints += group.IsJoint() ? group.count : 0;
  return joints;
}

int JointLayout::NumbersPerFrame() const {
  int numbers = 0;
  for (const JointGroup& group : groups) numbers += group.count * Width(group);
  return numbers;
}

Expected<JointLayout> ParseJointLayout(std::string_view text, const std::string& where) {
  const std::vector<std::string> tokens = Tokens(text);
  JointLayout layout;
  long long numbers = 0;
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
    numbers += static_cast<long long>(group.count) * Width(group);
    if (numbers > kMostNumbers) return Fail(ErrorCode::kConfig, "a frame of more than 100000 numbers", where);
    layout.groups.push_back(std::move(group));
  }
  if (layout.Joints() == 0) return Fail(ErrorCode::kConfig, "the layout has no joint", where, "as in 15*(x y z)");
  return layout;
}

Expected<JointRows> ParseJointRows(std::string_view bytes, const JointLayout& layout, JointTableLayout table,
                                   const std::string& name) {
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
  JointRows rows;
  rows.frames = read->frames;
  rows.joints = layout.Joints();
  rows.rows_left_over = read->rows_left_over;
  rows.findings = std::move(read->findings);
  const std::size_t frames = static_cast<std::size_t>(rows.frames);
  const std::size_t joints = frames * static_cast<std::size_t>(rows.joints);
  rows.position.resize(joints * 3);
  if (Has(layout, JointColumn::kConfidence)) rows.confidence.resize(joints, 1.0);
  if (Has(layout, JointColumn::kRotation)) rows.rotation.resize(joints * 9);
  if (Has(layout, JointColumn::kRotationConfidence)) rows.rotation_confidence.resize(joints);
  if (Has(layout, JointColumn::kFrame)) rows.frame_number.resize(frames);
  for (int f = 0; f < rows.frames; ++f) {
    PlaceFrame(layout, &read->values[static_cast<std::size_t>(f) * static_cast<std::size_t>(numbers)], f, rows);
  }
  KeepGaps(rows);
  CheckFrameNumbers(rows, name);
  return rows;
}

}  // namespace mocurate
