#include "core/formats/mended_frames.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/text.h"

namespace mocurate {
namespace {

/// The line of a row: lines without a number are none.
int LineOfRow(std::string_view bytes, long long row, int first_line) {
  int line = first_line;
  while (!bytes.empty()) {
    const std::size_t end = bytes.find('\n');
    const bool blank = bytes.substr(0, end).find_first_not_of(" \t\r,;") == std::string_view::npos;
    if (!blank && row-- == 0) break;
    if (end == std::string_view::npos) break;
    bytes.remove_prefix(end + 1);
    ++line;
  }
  return line;
}

std::string BreakWords(const RowBreak& at, const FrameOfRows& frame, long long number, int wanted) {
  const int count = std::abs(at.missing);
  const std::string rows = count == 1 ? "a row" : std::to_string(count) + " rows";
  const bool is = count == 1;
  std::string words = "frame " + std::to_string(number) + " has " + Counted(frame.rows, "row") + ", not " +
                      std::to_string(wanted) + ": ";
  if (at.row == 0) return words + rows + (at.missing > 0 ? (is ? " is missing" : " are missing") : " too many");
  if (at.missing > 0) return words + rows + (is ? " is" : " are") + " missing before this line";
  return words + rows + " too many " + (is ? "stands" : "stand") + " here";
}

/// Cuts the table into its frames anew where rows are missing or too many.
class FramesMended {
 public:
  FramesMended(JointTable& table, std::string_view bytes, const JointTableLayout& said, const std::string& name)
      : table_(table), bytes_(bytes), said_(said), name_(name) {}

  /// By the breaks found, or by those that leave the first frame odd.
  Status Mend(JointPerRow rows, OddFrame odd) {
    const int joints = table_.rows_per_frame;
    const std::size_t whole = table_.values.size();
    std::vector<double>& all = table_.values;
    all.insert(all.end(), table_.left_over.begin(), table_.left_over.end());
    rows.values = all.data();
    rows.rows = static_cast<long long>(all.size()) / table_.columns;
    const std::optional<std::vector<RowBreak>> breaks = BreaksOf(rows, odd);
    if (!breaks) {
      all.resize(whole);
      return {};
    }
    const std::vector<FrameOfRows> frames = FramesOfRows(rows.rows, joints, *breaks);
    const auto odd_frames = std::count_if(frames.begin(), frames.end(),
                                          [joints](const FrameOfRows& frame) { return frame.rows != joints; });
    if (2 * odd_frames > static_cast<std::ptrdiff_t>(frames.size())) {
      const FrameOfRows& first = *std::find_if(frames.begin(), frames.end(),
                                               [joints](const FrameOfRows& frame) { return frame.rows != joints; });
      return Fail(ErrorCode::kInconsistent,
                  std::to_string(odd_frames) + " of " + Counted(static_cast<long long>(frames.size()), "frame") +
                      " have another count of rows than " + std::to_string(joints) + ", the first " +
                      std::to_string(first.rows),
                  Place(first.first), "mend rows_per_frame and joints: the table is of another count of joints");
    }
    if (said_.damaged_rows == DamagedRows::kRefuse) return Refusal(breaks->front(), frames);
    const bool cut = frames.back().rows != joints && breaks->back().row < frames.back().first;
    Rebuild(frames, cut, FirstIsDoubted(breaks->front()));
    table_.left_over.clear();
    Tell(*breaks, frames, cut);
    return {};
  }

 private:
  /// Nothing: every row is where it belongs, or nothing tells where it does.
  std::optional<std::vector<RowBreak>> BreaksOf(const JointPerRow& rows, OddFrame odd) const {
    const int joints = table_.rows_per_frame;
    const int left_over = static_cast<int>(rows.rows % joints);
    std::vector<RowBreak> breaks = FindRowBreaks(rows, joints);
    long long missing = 0;
    for (const RowBreak& at : breaks) missing += at.missing;
    if (left_over == 0 && (rows.rows + missing) % joints != 0) return std::nullopt;  // the count speaks against them
    if (breaks.empty() && left_over != 0 && odd == OddFrame::kFirst) {
      breaks = {{0, left_over <= joints / 2 ? -left_over : joints - left_over}};
    }
    if (breaks.empty()) return std::nullopt;
    return breaks;
  }

  static std::size_t FrameOf(long long row, const std::vector<FrameOfRows>& frames) {
    std::size_t at = 0;
    while (at + 1 < frames.size() && frames[at + 1].first <= row) ++at;
    return at;
  }

  std::string Place(long long row) const {
    return name_ + ":" + std::to_string(LineOfRow(bytes_, row, said_.first_line));
  }

  /// The frame that a break leaves odd: its own, or, between two frames, the one before that lacks its last rows.
  std::size_t OddOf(const RowBreak& at, const std::vector<FrameOfRows>& frames) const {
    std::size_t frame = FrameOf(at.row, frames);
    if (frames[frame].rows == table_.rows_per_frame && frame > 0) --frame;
    return frame;
  }

  Status Refusal(const RowBreak& at, const std::vector<FrameOfRows>& frames) const {
    const std::size_t frame = OddOf(at, frames);
    return Fail(ErrorCode::kMalformed,
                BreakWords(at, frames[frame], static_cast<long long>(frame), table_.rows_per_frame), Place(at.row),
                "repair the file, or set ingest.source.damaged_rows: report, which costs that frame alone");
  }

  /// Rows too many where the second frame begins may stand anywhere in the first, of which nothing tells.
  bool FirstIsDoubted(const RowBreak& at) const {
    return at.missing < 0 && at.row > 0 && at.row <= table_.rows_per_frame + 1;
  }

  void Rebuild(const std::vector<FrameOfRows>& frames, bool cut, bool first_doubted) {
    const int joints = table_.rows_per_frame;
    const std::size_t size = static_cast<std::size_t>(joints) * static_cast<std::size_t>(table_.columns);
    const std::vector<double> all = std::move(table_.values);
    table_.frames = static_cast<int>(frames.size()) - (cut ? 1 : 0);
    table_.values.assign(static_cast<std::size_t>(table_.frames) * size, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t f = 0; f < static_cast<std::size_t>(table_.frames); ++f) {
      if (frames[f].rows != joints || (f == 0 && first_doubted)) continue;
      const auto from = all.begin() + static_cast<std::ptrdiff_t>(frames[f].first) * table_.columns;
      std::copy_n(from, size, table_.values.begin() + static_cast<std::ptrdiff_t>(f * size));
    }
  }

  void Tell(const std::vector<RowBreak>& breaks, const std::vector<FrameOfRows>& frames, bool cut) {
    const int joints = table_.rows_per_frame;
    std::vector<Finding> told;
    for (Finding finding : table_.findings) {
      if (finding.code == "cut_off" && !cut) continue;
      const int count = finding.frame_end - finding.frame_begin;
      const std::size_t frame = FrameOf(static_cast<long long>(finding.frame_begin) * joints, frames);
      finding.frame_begin = static_cast<int>(frame);
      finding.frame_end = finding.frame_begin + count;
      told.push_back(finding);
    }
    for (const RowBreak& at : breaks) {
      const std::size_t frame = OddOf(at, frames);
      Finding finding;
      finding.code = "frame_rows";
      finding.frame_begin = FirstIsDoubted(at) ? 0 : static_cast<int>(frame);
      finding.frame_end = static_cast<int>(frame) + 1;
      finding.value = frames[frame].rows;
      finding.message = Place(at.row) + ": " + BreakWords(at, frames[frame], static_cast<long long>(frame), joints) +
                        (FirstIsDoubted(at) ? "; it and frame 0 are" : "; the frame is") +
                        " taken for missing, what follows keeps its place";
      finding.action = FindingAction::kDropped;
      told.push_back(finding);
    }
    table_.findings = std::move(told);
  }

  JointTable& table_;
  std::string_view bytes_;
  const JointTableLayout& said_;
  const std::string& name_;
};

}  // namespace

Status MendFrames(JointPerRow rows, OddFrame odd, std::string_view bytes, const JointTableLayout& said,
                  const std::string& name, JointTable& table) {
  return FramesMended(table, bytes, said, name).Mend(rows, odd);
}

}  // namespace mocurate
