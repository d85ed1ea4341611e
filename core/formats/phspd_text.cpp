#include "core/formats/phspd_text.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/joint_table.h"
#include "core/formats/line_reader.h"
#include "core/formats/number_scanner.h"

namespace mocurate {
namespace {

constexpr int kPoseColumns = 1 + kPhspdJoints * 3;
constexpr int kShapeColumns = 1 + 3 + kPhspdBetas + kPhspdJoints * 3;
constexpr int kLargestFrame = 1'000'000'000;

std::string OfJoint(const char* what, int index) {
  return std::string(what) + " of joint " + std::to_string(index / 3) + ", " + "xyz"[index % 3];
}

/// Line of a row: blank lines do not count as rows.
int LineOfFilledRow(std::string_view bytes, int row) {
  LineReader lines(bytes, "");
  for (int i = 0; i <= row; ++i) lines.Next();
  return lines.number();
}

/// Replaces table rows by frames in the findings. A damaged row has no frame number: it is the frame after the row
/// before it. `rows` are those with a frame number.
void NameFrames(const std::vector<int>& rows, const std::vector<int>& frames, std::vector<Finding>& findings) {
  if (rows.empty()) return;
  const auto frame_of = [&](int row) {
    const auto after = static_cast<std::size_t>(std::upper_bound(rows.begin(), rows.end(), row) - rows.begin());
    if (after == 0) return frames[0] - (rows[0] - row);
    const int frame = frames[after - 1] + (row - rows[after - 1]);
    return after < rows.size() && row > rows[after - 1] ? std::min(frame, frames[after] - 1) : frame;
  };
  for (Finding& finding : findings) {
    const int last = finding.frame_end - 1;
    const bool any = last >= finding.frame_begin;
    finding.frame_begin = frame_of(finding.frame_begin);
    finding.frame_end = any ? frame_of(last) + 1 : finding.frame_begin;
  }
}

/// Rows of numbers; the first is the frame, and grows. Damaged rows have none.
Expected<JointTable> Rows(std::string_view bytes, std::vector<std::string> names, const std::string& name,
                          DamagedRows damaged, std::vector<int>& rows, std::vector<int>& frames) {
  JointTableLayout layout;
  layout.columns = static_cast<int>(names.size());
  layout.separator = JointTableLayout::Separator::kBlanks;
  layout.damaged_rows = damaged;
  layout.column_names = std::move(names);
  Expected<JointTable> table = ParseJointTable(bytes, layout, name);
  if (!table) return table;
  const auto headers = std::count_if(table->findings.begin(), table->findings.end(),
                                     [](const Finding& finding) { return finding.action == FindingAction::kExcluded; });
  for (int row = 0; row < table->frames; ++row) {
    const double frame = table->at(row, 0, 0);
    if (std::isnan(frame)) continue;
    const bool whole = frame == std::floor(frame) && frame >= 0 && frame <= kLargestFrame;
    if (!whole || (!frames.empty() && frame <= frames.back())) {
      return Fail(ErrorCode::kMalformed,
                  "frame " + FormatDouble(frame) +
                      (whole ? " does not come after frame " + std::to_string(frames.back())
                             : std::string(" is not a frame index")),
                  name + ":" + std::to_string(LineOfFilledRow(bytes, row + static_cast<int>(headers))),
                  "lines must be in the order of frames");
    }
    rows.push_back(row);
    frames.push_back(static_cast<int>(frame));
  }
  NameFrames(rows, frames, table->findings);
  return table;
}

void AppendRow(std::string& text, const std::vector<double>& values, std::size_t row, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) text += " " + FormatDouble(values[row * count + i]);
}

}  // namespace

Expected<PhspdPose> ParsePhspdPose(std::string_view bytes, const std::string& name, DamagedRows damaged) {
  std::vector<std::string> names = {"frame"};
  for (int i = 0; i < kPhspdJoints * 3; ++i) names.push_back(OfJoint("position", i));
  PhspdPose pose;
  std::vector<int> rows;
  Expected<JointTable> table = Rows(bytes, std::move(names), name, damaged, rows, pose.frame);
  if (!table) return Forward(table);
  pose.findings = std::move(table->findings);
  pose.position_m.reserve(rows.size() * kPhspdJoints * 3);
  for (const int row : rows) {
    const auto begin = table->values.begin() + static_cast<std::ptrdiff_t>(row) * kPoseColumns;
    pose.position_m.insert(pose.position_m.end(), begin + 1, begin + kPoseColumns);
  }
  return pose;
}

Expected<PhspdShape> ParsePhspdShape(std::string_view bytes, const std::string& name) {
  std::vector<std::string> names = {"frame", "translation x", "translation y", "translation z"};
  for (int i = 0; i < kPhspdBetas; ++i) names.push_back("beta " + std::to_string(i));
  for (int i = 0; i < kPhspdJoints * 3; ++i) names.push_back(OfJoint("rotation", i));
  PhspdShape shape;
  std::vector<int> rows;
  const Expected<JointTable> table = Rows(bytes, std::move(names), name, DamagedRows::kRefuse, rows, shape.frame);
  if (!table) return Forward(table);
  for (int row = 0; row < table->frames; ++row) {
    const auto begin = table->values.begin() + static_cast<std::ptrdiff_t>(row) * kShapeColumns;
    shape.translation_m.insert(shape.translation_m.end(), begin + 1, begin + 4);
    shape.betas.insert(shape.betas.end(), begin + 4, begin + 4 + kPhspdBetas);
    shape.pose_rad.insert(shape.pose_rad.end(), begin + 4 + kPhspdBetas, begin + kShapeColumns);
  }
  return shape;
}

std::string WritePhspdPose(const PhspdPose& pose) {
  std::string text;
  for (std::size_t row = 0; row < pose.frame.size(); ++row) {
    text += std::to_string(pose.frame[row]);
    AppendRow(text, pose.position_m, row, std::size_t{3} * kPhspdJoints);
    text += "\n";
  }
  return text;
}

std::string WritePhspdShape(const PhspdShape& shape) {
  std::string text;
  for (std::size_t row = 0; row < shape.frame.size(); ++row) {
    text += std::to_string(shape.frame[row]);
    AppendRow(text, shape.translation_m, row, 3);
    AppendRow(text, shape.betas, row, kPhspdBetas);
    AppendRow(text, shape.pose_rad, row, std::size_t{3} * kPhspdJoints);
    text += "\n";
  }
  return text;
}

std::string PhspdRecording::Name() const {
  return "subject" + ZeroPadded(subject, 2) + "_group" + std::to_string(group) + "_time" + std::to_string(time);
}

std::optional<PhspdRecording> ParsePhspdRecording(std::string_view folder) {
  const std::vector<std::string_view> parts = SplitText(folder, '_');
  constexpr std::string_view kWords[] = {"subject", "group", "time"};
  if (parts.size() != 3) return std::nullopt;
  int numbers[3] = {0, 0, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    const bool known = parts[i].substr(0, kWords[i].size()) == kWords[i];
    const std::string_view digits = known ? parts[i].substr(kWords[i].size()) : std::string_view();
    const bool whole = digits.find_first_not_of("0123456789") == std::string_view::npos;
    const std::optional<long long> number = whole ? ParseInteger(digits) : std::nullopt;
    if (!number || *number < 1 || *number > 999) return std::nullopt;
    numbers[i] = static_cast<int>(*number);
  }
  return PhspdRecording{numbers[0], numbers[1], numbers[2]};
}

}  // namespace mocurate
