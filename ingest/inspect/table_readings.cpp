#include "ingest/inspect/table_readings.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/formats/row_counter.h"
#include "ingest/inspect/comparison.h"

namespace mocurate {
namespace {

constexpr int kFewestTableJoints = 10;
constexpr int kMostTableJoints = 60;

constexpr const char* kCad60 = "frame 11*(rotation rotation_confidence x y z confidence) 4*(x y z confidence)";

/// Of a joint in a frame: its row, and the column of its first number.
struct TableCell {
  int row = 0;
  int column = 0;
};

TableCell CellOfJoint(const RowLayout& layout, int frame, int joint) {
  const int per_row = layout.joints / layout.rows_per_frame;
  return {frame * layout.rows_per_frame + joint / per_row,
          layout.x_columns.empty() ? layout.first_column + (joint % per_row) * layout.columns_per_joint
                                   : layout.x_columns[static_cast<std::size_t>(joint)]};
}

/// Whether the numbers behind x, y, z lie in 0..1 throughout: confidences. CAD-60's are.
bool HasConfidences(const JointTable& rows, const RowLayout& layout) {
  if (!layout.x_columns.empty()) return true;
  if (layout.columns_per_joint != 4) return false;
  for (int row = 0; row < rows.frames; ++row) {
    for (int c = layout.first_column + 3; c < rows.columns; c += 4) {
      const double value = rows.at(row, 0, c);
      if (!(value >= 0.0 && value <= 1.0)) return false;
    }
  }
  return true;
}

/// How a source would declare the layout; `leading`: words of the columns before the joints.
void AddLayoutFacts(const RowLayout& layout, const std::vector<std::string>& leading, bool confidences, RawClip& clip) {
  if (!layout.x_columns.empty()) {
    clip.facts.emplace_back("layout", kCad60);
    return;
  }
  const std::string fourth = layout.columns_per_joint != 4 ? "" : confidences ? "confidence" : "skip";
  const bool joint_a_row = layout.rows_per_frame > 1;
  std::string before;
  for (const std::string& word : leading) before += word + (joint_a_row ? ", " : " ");
  if (joint_a_row) {
    clip.facts.emplace_back("columns", before + "x, y, z" + (fourth.empty() ? "" : ", " + fourth));
    return;
  }
  clip.facts.emplace_back(
      "layout", before + std::to_string(layout.joints) + "*(x y z" + (fourth.empty() ? "" : " " + fourth) + ")");
}

/// Joints whose confidence is 0 are missing in CAD-60's layout; of other tables nothing says that the fourth number is
/// a confidence, or that 0 means unobserved (MSR-Action3D has 0 for trunks that it follows): how many are missing is
/// then not known.
void CountMissing(const JointTable& rows, const RowLayout& layout, bool confidences, RawClip& clip) {
  const auto samples = static_cast<double>(clip.confidence.size());
  const auto at_origin = std::count(clip.zeros.begin(), clip.zeros.end(), 1);
  if (at_origin > 0) clip.facts.emplace_back("at_origin", RoundedText(static_cast<double>(at_origin) / samples));
  if (!confidences) return;
  std::size_t unsure = 0, missing = 0, placed = 0, at = 0;
  for (int f = 0; f < clip.frames; ++f) {
    for (int j = 0; j < clip.joints; ++j, ++at) {
      const TableCell place = CellOfJoint(layout, f, j);
      const bool none = !(rows.at(place.row, 0, place.column + 3) > 0.0);
      unsure += none ? 1 : 0;
      placed += none && clip.confidence[at] > 0.0 ? 1 : 0;
      missing += none || clip.confidence[at] == 0.0 ? 1 : 0;
    }
  }
  if (unsure == 0) return;
  if (!layout.x_columns.empty()) {
    clip.missing_share = static_cast<double>(missing) / samples;
    clip.missing_evidence = "joints that are zero, no numbers, or have confidence 0";
    return;
  }
  clip.guessed_share = static_cast<double>(placed) / samples;
  clip.missing_evidence = "the number behind x, y, z lies in 0 to 1 and is 0 for " +
                          RoundedText(100.0 * static_cast<double>(unsure) / samples, 3) +
                          " % of the joints: whether it is a confidence, and these were not seen, the file does not "
                          "declare; a source does (`columns`, `least_confidence`)";
}

/// A column before the joints.
struct LeadingColumn {
  std::vector<double> values;  ///< (frames)
  CounterEstimate estimate;
  std::string header;
};

std::vector<LeadingColumn> LeadingColumns(const JointTable& rows, const RowLayout& layout) {
  std::vector<LeadingColumn> columns(static_cast<std::size_t>(layout.x_columns.empty() ? layout.first_column : 1));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    for (int row = 0; row < rows.frames; row += layout.rows_per_frame)
      columns[c].values.push_back(rows.at(row, 0, static_cast<int>(c)));
    if (c < rows.names.size()) columns[c].header = rows.names[c];
    columns[c].estimate = EstimateCounter(columns[c].values, CounterNameOf(columns[c].header));
  }
  return columns;
}

/// The column that lays out the frames: a clock, else numbers of frames, else one that may be either; null: none.
const LeadingColumn* CounterOf(const std::vector<LeadingColumn>& columns) {
  for (const Counter counter : {Counter::kTime, Counter::kFrames, Counter::kAmbiguous}) {
    for (const LeadingColumn& column : columns) {
      if (column.estimate.counter == counter) return &column;
    }
  }
  return nullptr;
}

/// The numbers of the frames, or their places by the clock; empty where there are none.
std::vector<double> FrameNumbersOf(const LeadingColumn& column) {
  const std::vector<double>& values = column.values;
  if (column.estimate.counter == Counter::kFrames) {
    const auto falls = std::adjacent_find(values.begin(), values.end(), [](double a, double b) { return !(b > a); });
    return falls == values.end() && !std::isnan(values[0]) ? values : std::vector<double>();
  }
  const Expected<RowPlaces> places = PlacesByClock(values, "");
  if (!places) return {};
  std::vector<double> numbers;
  for (const int place : places->place) numbers.push_back(place >= 0 ? place : numbers.back());
  return numbers;
}

/// What the leading columns say of frames and rate. Returns their words in a layout.
std::vector<std::string> FollowCounter(const JointTable& rows, const RowLayout& layout, RawClip& clip) {
  const std::vector<LeadingColumn> columns = LeadingColumns(rows, layout);
  const LeadingColumn* counter = CounterOf(columns);
  std::vector<std::string> words(columns.size(), "skip");
  const bool known = !layout.x_columns.empty();  // the first column counts frames
  if (counter == nullptr || (known && counter->estimate.counter != Counter::kFrames)) return words;
  const CounterEstimate& estimate = counter->estimate;
  std::string& word = words[static_cast<std::size_t>(counter - columns.data())];
  const std::string called =
      counter->header.empty() ? "the first column" : "the column '" + counter->header + "' of the header";
  if (estimate.counter == Counter::kAmbiguous) {
    word = kFillIn;
    clip.remarks.push_back(MakeFinding("layout_ambiguous", Severity::kWarning, estimate.step,
                                       called + " may count frames or be a clock (" + estimate.words + "; usual step " +
                                           FormatDouble(estimate.step) +
                                           "): declare it as `frame`, or as a time in its unit (time_s, time_ms, "
                                           "time_us, time_100ns, time_ns)"));
    return words;
  }
  clip.frame_numbers = FrameNumbersOf(*counter);
  if (estimate.counter == Counter::kFrames) {
    word = "frame";
    return words;
  }
  const ClockUnit& unit = estimate.units[0];
  word = std::string("time_") + unit.name;
  const double hz = 1.0 / (estimate.step * unit.seconds);
  clip.rate_hz = NearestUsualRate(hz).value_or(std::round(1000.0 * hz) / 1000.0);
  clip.rate_evidence = called + " is a clock: " + estimate.words;
  clip.rate_finding = CheckStatedRate(*clip.rate_hz, RateUnit::kFramesPerSecond, called);
  clip.rate_measured = counter->header.empty();
  return words;
}

/// Frames that the numbers skip.
void ReportGaps(RawClip& clip) {
  double skipped = 0.0, longest = 0.0;
  std::string first;
  for (std::size_t f = 1; f < clip.frame_numbers.size(); ++f) {
    const double gap = clip.frame_numbers[f] - clip.frame_numbers[f - 1] - 1.0;
    if (gap <= 0.0) continue;
    skipped += gap;
    longest = std::max(longest, gap);
    if (first.empty())
      first = FormatDouble(clip.frame_numbers[f - 1]) + " is followed by " + FormatDouble(clip.frame_numbers[f]);
  }
  if (first.empty()) return;
  clip.remarks.push_back(
      MakeFinding("time_gap", Severity::kWarning, skipped,
                  Counted(static_cast<long long>(skipped), "frame") + " of those that are numbered from " +
                      FormatDouble(clip.frame_numbers.front()) + " to " + FormatDouble(clip.frame_numbers.back()) +
                      " have no row, at most " + FormatDouble(longest) + " on end; the first: " + first));
}

/// CAD-60: frame number; 11 joints with 9 orientation values, their confidence, x y z, confidence; 4 joints without.
RowLayout Cad60RowLayout() {
  RowLayout layout{15, 1, 0, 3, {}, "171 numbers a row: frame number, 11 joints with orientation, 4 without (CAD-60)"};
  for (int j = 0; j < 11; ++j) layout.x_columns.push_back(1 + 14 * j + 10);
  for (int j = 0; j < 4; ++j) layout.x_columns.push_back(1 + 14 * 11 + 4 * j);
  return layout;
}

/// How many rows on end have each number of the first column, where that rises by whole numbers; 0: it does not.
int RowsCountedAlike(const JointTable& rows) {
  int alike = 0;
  for (int row = 0, first = 0; row <= rows.frames; ++row) {
    const bool same = row < rows.frames && rows.at(row, 0, 0) == rows.at(first, 0, 0);
    if (same) continue;
    const double number = rows.at(first, 0, 0);
    const bool counts = std::isfinite(number) && number == std::floor(number);
    if (!counts || (row < rows.frames && !(rows.at(row, 0, 0) > number))) return 0;
    if (alike != 0 && row - first != alike) return 0;
    alike = row - first;
    first = row;
  }
  return alike < rows.frames ? alike : 0;
}

/// Whether the second column says the same whole numbers in every frame, each once.
bool CountsJoints(const JointTable& rows, int joints) {
  std::set<double> numbers;
  for (int row = 0; row < rows.frames; ++row) {
    const double number = rows.at(row, 0, 1);
    if (row < joints && (number != std::floor(number) || !numbers.insert(number).second)) return false;
    if (number != rows.at(row % joints, 0, 1)) return false;
  }
  return true;
}

/// Columns up to the last of the first ones that a header names as frames or times; 0: none.
int NamedLeading(const std::vector<std::string>& names) {
  constexpr std::size_t kFirst = 4;
  int leading = 0;
  for (std::size_t c = 0; c < std::min(kFirst, names.size()); ++c) {
    const CounterName name = CounterNameOf(names[c]);
    if (name.time || name.frame) leading = static_cast<int>(c) + 1;
  }
  return leading;
}

bool IsKnownCount(int joints) {
  const std::vector<JointOrder>& orders = KnownJointOrders();
  return std::any_of(orders.begin(), orders.end(),
                     [&](const JointOrder& order) { return static_cast<int>(order.joints.size()) == joints; });
}

}  // namespace

RawClip ReadRows(const JointTable& rows, const RowLayout& layout) {
  RawClip clip;
  clip.format = "joint_table";
  clip.joints = layout.joints;
  clip.frames = rows.frames / layout.rows_per_frame;
  clip.positions = JointPositions(clip.frames, clip.joints);
  clip.confidence.assign(static_cast<std::size_t>(clip.frames) * clip.joints, 0.0);
  clip.zeros.assign(clip.confidence.size(), 0);
  for (int f = 0; f < clip.frames; ++f) {
    for (int j = 0; j < clip.joints; ++j) {
      const TableCell place = CellOfJoint(layout, f, j);
      const auto number = [&](int axis) { return rows.at(place.row, 0, place.column + axis); };
      const Vector3d value(number(0), number(1), number(2));
      const std::size_t at =
          static_cast<std::size_t>(f) * static_cast<std::size_t>(clip.joints) + static_cast<std::size_t>(j);
      clip.zeros[at] = value.isZero(0.0) ? 1 : 0;
      if (!value.allFinite() || value.isZero(0.0)) continue;
      clip.positions.at(f, j) = value;
      clip.confidence[at] = 1.0;
    }
  }
  const std::vector<std::string> leading = FollowCounter(rows, layout, clip);
  ReportGaps(clip);
  clip.layout_evidence = layout.words + (clip.rate_hz ? "; " + clip.rate_evidence : "");
  const bool confidences = HasConfidences(rows, layout);
  AddLayoutFacts(layout, leading, confidences, clip);
  CountMissing(rows, layout, confidences, clip);
  return clip;
}

std::string RowWords(int rows, int joints, int columns) {
  return std::to_string(rows) + " rows of " + std::to_string(columns) + " numbers = " + std::to_string(rows / joints) +
         " frames of " + std::to_string(joints) + " joints, one a row";
}

std::vector<RowLayout> PossibleLayouts(const JointTable& rows) {
  const int columns = rows.columns;
  std::vector<RowLayout> layouts;
  if (columns == 171) layouts.push_back(Cad60RowLayout());
  if (columns == 3 || columns == 4) {
    for (int joints = kFewestTableJoints; joints <= kMostTableJoints; ++joints) {
      if (rows.frames % joints == 0)
        layouts.push_back({joints, joints, 0, columns, {}, RowWords(rows.frames, joints, columns)});
    }
    return layouts;
  }
  const int named = NamedLeading(rows.names);
  for (const int leading : named > 0 ? std::vector<int>{named} : std::vector<int>{0, 1}) {
    for (const int per_joint : {3, 4}) {
      const int rest = columns - leading;
      const int joints = rest / per_joint;
      if (rest % per_joint != 0 || joints < kFewestTableJoints || joints > kMostTableJoints) continue;
      layouts.push_back({joints,
                         1,
                         leading,
                         per_joint,
                         {},
                         "rows of " + std::to_string(columns) + " numbers: one frame of " + std::to_string(joints) +
                             " joints with " + std::to_string(per_joint) + " each" +
                             (leading == 0   ? ""
                              : leading == 1 ? " after one leading number"
                                             : " after " + std::to_string(leading) + " leading numbers")});
    }
  }
  return layouts;
}

std::optional<RowLayout> CountedLayout(const JointTable& rows) {
  for (const int leading : {2, 1}) {
    const int rest = rows.columns - leading;
    if (rest != 3 && rest != 4) continue;
    const int joints = RowsCountedAlike(rows);
    if (joints < kFewestTableJoints || joints > kMostTableJoints || rows.frames % joints != 0) continue;
    if (leading == 2 && !CountsJoints(rows, joints)) continue;
    return RowLayout{joints,
                     joints,
                     leading,
                     rest,
                     {},
                     RowWords(rows.frames, joints, rows.columns) + ": the first counts the frames" +
                         (leading == 2 ? ", the second the joints" : "")};
  }
  return std::nullopt;
}

double Roughness(const RawClip& clip) {
  std::vector<double> steps, sizes;
  const int step = std::max(1, clip.frames / 64);
  const auto seen = [&](int f, int j) { return clip.confidence[static_cast<std::size_t>(f) * clip.joints + j] > 0.0; };
  for (int f = 0; f + 1 < clip.frames; f += step) {
    for (int j = 0; j < clip.joints; ++j) {
      if (seen(f, j) && seen(f + 1, j)) steps.push_back((clip.positions.at(f + 1, j) - clip.positions.at(f, j)).norm());
      if (seen(f, j) && seen(f, 0)) sizes.push_back((clip.positions.at(f, j) - clip.positions.at(f, 0)).norm());
    }
  }
  if (steps.empty() || sizes.empty()) return 1.0;
  const double size = Median(std::move(sizes));
  return size > 0.0 ? Median(std::move(steps)) / size : 1.0;
}

std::optional<RawClip> KnownLayout(const JointTable& rows, const std::vector<RowLayout>& layouts) {
  std::optional<RawClip> best;
  std::string others;
  for (const RowLayout& layout : layouts) {
    if (!IsKnownCount(layout.joints)) continue;
    RawClip clip = ReadRows(rows, layout);
    if (!RecogniseOrder(clip) || Roughness(clip) > kSmooth) continue;
    const bool better = !best || clip.skeleton.confidence > best->skeleton.confidence;
    if (best) {
      others += (others.empty() ? "" : ", ") + std::to_string(better ? best->joints : clip.joints);
    }
    if (better) best = std::move(clip);
  }
  if (best && !others.empty()) {
    best->remarks.push_back(MakeFinding("layout_ambiguous", Severity::kWarning, best->skeleton.confidence,
                                        "the row count also allows " + others +
                                            " joints, and bone lengths do not exclude it; this reading is " +
                                            RoundedText(100.0 * best->skeleton.confidence, 3) + " % confidence"));
  }
  return best;
}

}  // namespace mocurate
