#include "ingest/inspect/table_readings.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/formats/joint_layout.h"
#include "core/formats/row_counter.h"

namespace mocurate {
namespace {

constexpr int kFewestTableJoints = 10;
constexpr int kMostTableJoints = 60;

constexpr const char* kCad60 = "frame 11*(rotation rotation_confidence x y z confidence) 4*(x y z confidence)";

/// The numbers of the joints. What nothing says of them stands as confidences.
JointRows RowsIn(const JointTable& rows, const RowLayout& layout) {
  const Expected<JointLayout> parsed = ParseJointLayout(WithFilledIn(layout.Text(), "confidence"), "");
  return parsed ? RowsOf(rows, *parsed, "").value_or(JointRows()) : JointRows();
}

/// One number of every frame.
std::vector<double> NumbersAt(const JointTable& rows, const RowLayout& layout, std::size_t number) {
  const auto wide = static_cast<std::size_t>(layout.rows_per_frame) * static_cast<std::size_t>(rows.columns);
  std::vector<double> values;
  for (std::size_t at = number; at + wide <= rows.values.size() + number; at += wide) values.push_back(rows.values[at]);
  return values;
}

/// Joints whose confidence is 0 are missing where a known layout or a header says so. Of other tables nothing says that
/// the fourth number is a confidence, or that 0 means unobserved (MSR-Action3D has 0 for trunks that it follows): how
/// many are missing is then not known.
void CountMissing(const JointTable& rows, const RowLayout& layout, RawClip& clip) {
  const auto samples = static_cast<double>(clip.confidence.size());
  const auto at_origin = std::count(clip.zeros.begin(), clip.zeros.end(), 1);
  if (at_origin > 0) clip.facts.emplace_back("at_origin", RoundedText(static_cast<double>(at_origin) / samples));
  const std::vector<double> numbers = RowsIn(rows, layout).confidence;
  const bool declared = layout.Text().find("confidence") != std::string::npos;
  const bool in_range = std::all_of(numbers.begin(), numbers.end(), [](double c) { return c >= 0.0 && c <= 1.0; });
  if (numbers.size() != clip.confidence.size() || !(declared || in_range)) return;
  std::size_t unsure = 0, missing = 0, placed = 0;
  for (std::size_t at = 0; at < numbers.size(); ++at) {
    const bool seen = clip.confidence[at] > 0.0, none = !(numbers[at] > 0.0);
    unsure += none ? 1 : 0;
    placed += none && seen ? 1 : 0;
    missing += none || !seen ? 1 : 0;
  }
  if (unsure == 0) return;
  if (declared) {
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

/// A column that may count the frames.
struct BesideColumn {
  std::size_t number = 0;  ///< among the columns of a row
  CounterEstimate estimate;
};

std::vector<BesideColumn> ColumnsBeside(const JointTable& rows, const RowLayout& layout) {
  std::vector<BesideColumn> beside;
  for (std::size_t c = 0; c < layout.columns.size(); ++c) {
    if (!layout.columns[c].joint.empty() || !layout.columns[c].word.empty()) continue;
    beside.push_back({c, EstimateCounter(NumbersAt(rows, layout, c), CounterNameOf(layout.columns[c].cell))});
  }
  return beside;
}

/// The column that lays out the frames: a clock, else numbers of frames, else one that may be either; null: none.
const BesideColumn* CounterOf(const std::vector<BesideColumn>& columns) {
  for (const Counter counter : {Counter::kTime, Counter::kFrames, Counter::kAmbiguous}) {
    for (const BesideColumn& column : columns) {
      if (column.estimate.counter == counter) return &column;
    }
  }
  return nullptr;
}

/// Names the column that counts the frames, with what it says of the rate; the others are passed over.
void NameCounter(const JointTable& rows, RowLayout& layout, RawClip& clip) {
  if (layout.fixed == kCad60) {
    if (EstimateCounter(NumbersAt(rows, layout, 0)).counter != Counter::kFrames) layout.fixed.replace(0, 5, "skip");
  }
  const std::vector<BesideColumn> beside = ColumnsBeside(rows, layout);
  for (const BesideColumn& column : beside) layout.columns[column.number].word = "skip";
  const BesideColumn* counter = CounterOf(beside);
  if (counter == nullptr) return;
  const CounterEstimate& estimate = counter->estimate;
  HeaderColumn& column = layout.columns[counter->number];
  const std::string called =
      column.cell.empty() ? "the first column" : "the column '" + column.cell + "' of the header";
  if (estimate.counter == Counter::kAmbiguous) {
    column.word = kFillIn;
    clip.remarks.push_back(MakeFinding("layout_ambiguous", Severity::kWarning, estimate.step,
                                       called + " may count frames or be a clock (" + estimate.words + "; usual step " +
                                           FormatDouble(estimate.step) +
                                           "): declare it as `frame`, or as a time in its unit (time_s, time_ms, "
                                           "time_us, time_100ns, time_ns)"));
  } else if (estimate.counter == Counter::kFrames) {
    column.word = "frame";
  } else {
    column.word = std::string("time_") + estimate.units[0].name;
    clip.rate_evidence = called + " is a clock: " + estimate.words;
    clip.rate_measured = column.cell.empty();
  }
}

/// CAD-60: frame number; 11 joints with 9 orientation values, their confidence, x y z, confidence; 4 joints without.
RowLayout Cad60RowLayout() {
  RowLayout layout;
  layout.joints = 15;
  layout.fixed = kCad60;
  layout.words = "171 numbers a row: frame number, 11 joints with orientation, 4 without (CAD-60)";
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

/// Whether the first of the four numbers of each joint is a whole number of its own, the same in every row.
bool HasJointIndex(const JointTable& rows, int leading, int joints) {
  std::set<double> numbers;
  for (int j = 0; j < joints; ++j) {
    const double number = rows.at(0, 0, leading + 4 * j);
    if (!(number == std::floor(number)) || !numbers.insert(number).second) return false;
    for (int row = 1; row < rows.frames; ++row) {
      if (rows.at(row, 0, leading + 4 * j) != number) return false;
    }
  }
  return true;
}

/// Whether the columns from `first` on are zero, or no numbers, in every row.
bool AreAbsent(const JointTable& rows, int first) {
  for (int row = 0; row < rows.frames; ++row) {
    for (int c = first; c < rows.columns; ++c) {
      const double value = rows.at(row, 0, c);
      if (value != 0.0 && !std::isnan(value)) return false;
    }
  }
  return true;
}

/// Columns before the joints, which may be named.
std::vector<HeaderColumn> Leading(const JointTable& rows, int count) {
  const std::vector<std::string> names = rows.names();
  std::vector<HeaderColumn> columns(static_cast<std::size_t>(count));
  for (std::size_t c = 0; c < std::min(columns.size(), names.size()); ++c) columns[c].cell = names[c];
  return columns;
}

void AddJoint(int joint, const std::vector<std::string>& words, std::vector<HeaderColumn>& columns) {
  for (const std::string& word : words) columns.push_back({std::to_string(joint), word, "", ""});
}

/// A frame in each row, of `joints` behind `leading` numbers.
RowLayout OneFrameARow(const JointTable& rows, int joints, int leading, int per_joint) {
  RowLayout layout;
  layout.joints = joints;
  layout.columns = Leading(rows, leading);
  std::vector<std::string> words = {"x", "y", "z"};
  if (per_joint == 4) words.push_back(kFillIn);
  if (per_joint == 4 && HasJointIndex(rows, leading, joints)) words = {"skip", "x", "y", "z"};
  for (int j = 0; j < joints; ++j) AddJoint(j, words, layout.columns);
  layout.words = "rows of " + std::to_string(rows.columns) + " numbers: one frame of " + std::to_string(joints) +
                 " joints with " + std::to_string(per_joint) + " each" +
                 (leading == 0   ? ""
                  : leading == 1 ? " after one leading number"
                                 : " after " + std::to_string(leading) + " leading numbers");
  return layout;
}

/// The same of the first of two people; nothing of another count of columns.
std::optional<RowLayout> FirstOfTwo(const JointTable& rows, int leading, int per_joint) {
  const int rest = rows.columns - leading;
  const int joints = rest / (2 * per_joint), numbers = joints * per_joint;
  if (rest != 2 * numbers || !IsKnownCount(joints)) return std::nullopt;
  RowLayout first = OneFrameARow(rows, joints, leading, per_joint), second = first;
  const std::vector<HeaderColumn> passed(static_cast<std::size_t>(numbers), {"", "skip", "", ""});
  second.columns.insert(second.columns.begin() + leading, passed.begin(), passed.end());
  first.columns.insert(first.columns.end(), passed.begin(), passed.end());
  first.words += ", and as many of a second person";
  if (AreAbsent(rows, leading + numbers)) {
    first.words += ", who is zero throughout: absent";
    return first;
  }
  RawClip other = ReadPoints(rows, second);
  if (!RecogniseOrder(other)) return std::nullopt;
  first.second_person = true;
  return first;
}

/// A joint in each row, behind `leading` numbers.
RowLayout OneJointARow(const JointTable& rows, int joints, int leading) {
  RowLayout layout;
  layout.joints = layout.rows_per_frame = joints;
  layout.columns = Leading(rows, leading);
  std::vector<std::string> words = {"x", "y", "z"};
  if (rows.columns - leading == 4) words.push_back(kFillIn);
  AddJoint(0, words, layout.columns);
  layout.words = RowWords(rows.frames, joints, rows.columns);
  return layout;
}

/// Words of a row, those undecided as `skip`.
std::vector<std::string> WordsOf(const std::vector<HeaderColumn>& columns) {
  std::vector<std::string> words;
  for (const HeaderColumn& column : columns) words.push_back(column.word.empty() ? "skip" : column.word);
  return words;
}

}  // namespace

std::string WithFilledIn(std::string text, const char* word) {
  const std::size_t length = std::string_view(kFillIn).size();
  for (std::size_t at = 0; (at = text.find(kFillIn, at)) != std::string::npos;) text.replace(at, length, word);
  return text;
}

std::string RowLayout::Text() const {
  if (!fixed.empty()) return fixed;
  const std::vector<std::string> each = WordsOf(columns);
  if (rows_per_frame > 1) return std::to_string(joints) + "*(" + JoinTexts(each, " ") + ")";
  return LayoutWords(columns, each);
}

RawClip ReadPoints(const JointTable& rows, const RowLayout& layout) {
  RawClip clip;
  clip.format = "joint_table";
  clip.joints = layout.joints;
  clip.joints_measured = true;
  const JointRows points = RowsIn(rows, layout);
  clip.TakePoints(points.frames, points.position);
  return clip;
}

void DeclareLayout(const JointTable& rows, RowLayout& layout, RawClip& clip) {
  CountMissing(rows, layout, clip);
  NameCounter(rows, layout, clip);
  clip.layout_evidence = layout.words + (clip.rate_evidence.empty() ? "" : "; " + clip.rate_evidence);
  const bool by_columns = layout.rows_per_frame > 1;
  clip.facts.emplace_back(by_columns ? "columns" : "layout",
                          by_columns ? JoinTexts(WordsOf(layout.columns), ", ") : layout.Text());
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
      if (rows.frames % joints == 0) layouts.push_back(OneJointARow(rows, joints, 0));
    }
    return layouts;
  }
  const int named = NamedLeading(rows.names());
  for (const int leading : named > 0 ? std::vector<int>{named} : std::vector<int>{0, 1}) {
    for (const int per_joint : {3, 4}) {
      const int rest = columns - leading;
      const int joints = rest / per_joint;
      if (auto first = FirstOfTwo(rows, leading, per_joint)) layouts.push_back(*std::move(first));
      if (rest % per_joint != 0 || joints < kFewestTableJoints || joints > kMostTableJoints) continue;
      layouts.push_back(OneFrameARow(rows, joints, leading, per_joint));
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
    RowLayout layout = OneJointARow(rows, joints, leading);
    layout.words += std::string(": the first counts the frames") + (leading == 2 ? ", the second the joints" : "");
    return layout;
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

std::optional<TableReading> KnownLayout(const JointTable& rows, const std::vector<RowLayout>& layouts) {
  std::optional<TableReading> best;
  std::string others;
  for (const RowLayout& layout : layouts) {
    if (!IsKnownCount(layout.joints)) continue;
    RawClip clip = ReadPoints(rows, layout);
    if (!RecogniseOrder(clip) || Roughness(clip) > kSmooth) continue;
    const bool better = !best || clip.skeleton.confidence > best->clip.skeleton.confidence;
    if (best) {
      others += (others.empty() ? "" : ", ") + std::to_string(better ? best->clip.joints : clip.joints);
    }
    if (better) best = TableReading{layout, std::move(clip)};
  }
  if (best && !others.empty()) {
    best->clip.remarks.push_back(MakeFinding(
        "layout_ambiguous", Severity::kWarning, best->clip.skeleton.confidence,
        "the row count also allows " + others + " joints, and bone lengths do not exclude it; this reading is " +
            RoundedText(100.0 * best->clip.skeleton.confidence, 3) + " % confidence"));
  }
  return best;
}

}  // namespace mocurate
