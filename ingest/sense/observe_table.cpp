#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/joint_layout.h"
#include "core/formats/joint_table.h"
#include "core/formats/number_scanner.h"
#include "ingest/sense/observe.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

constexpr int kFewestJoints = 10;
constexpr int kMostJoints = 60;
constexpr const char* kAxisColumns[] = {"x", "y", "z"};
constexpr double kSmooth = 0.35;  // a frame's step against the size of the body: a body moves less

/// Where the numbers of a table stand, if a frame is read in one way.
struct Layout {
  int joints = 0;
  int rows_per_frame = 0;
  int first_column = 0;  ///< of the first joint in a row
  int columns_per_joint = 3;
  std::vector<int> x_columns;  ///< (joints) where it is irregular: column of x
  std::string words;
  int axis[3] = {0, 1, 2};  ///< columns of x, y, z after the joint's first
};

constexpr const char* kCad60 = "frame 11*(rotation rotation_confidence x y z confidence) 4*(x y z confidence)";

/// How a source would declare the layout; a fourth number that lies in 0..1 throughout is a confidence.
void AddLayoutFacts(const JointTable& rows, const Layout& layout, ObservedClip& clip) {
  if (!layout.x_columns.empty()) {
    clip.facts.emplace_back("layout", kCad60);
    return;
  }
  std::string fourth;
  if (layout.columns_per_joint == 4) {
    bool confidence = true;
    for (int row = 0; row < rows.frames && confidence; ++row) {
      for (int c = layout.first_column + 3; c < rows.columns && confidence; c += 4) {
        const double value = rows.at(row, 0, c);
        confidence = value >= 0.0 && value <= 1.0;
      }
    }
    fourth = confidence ? "confidence" : "skip";
  }
  if (layout.rows_per_frame > 1) {
    clip.facts.emplace_back("columns", "x, y, z" + (fourth.empty() ? "" : ", " + fourth));
    return;
  }
  clip.facts.emplace_back("layout", std::string(layout.first_column > 0 ? "frame " : "") +
                                        std::to_string(layout.joints) + "*(x y z" +
                                        (fourth.empty() ? "" : " " + fourth) + ")");
}

/// The leading numbers, where they count the frames: whole, rising, mostly by one (by more, they are times).
std::vector<double> FrameNumbers(const JointTable& rows, const Layout& layout) {
  const bool leads = layout.rows_per_frame == 1 && (layout.first_column == 1 || !layout.x_columns.empty());
  if (!leads) return {};
  std::vector<double> numbers;
  int by_one = 0;
  for (int f = 0; f < rows.frames; ++f) {
    const double number = rows.at(f, 0, 0);
    if (!std::isfinite(number) || number != std::floor(number)) return {};
    if (f > 0 && number <= numbers.back()) return {};
    if (f > 0 && number == numbers.back() + 1.0) ++by_one;
    numbers.push_back(number);
  }
  if (2 * by_one < rows.frames - 1) return {};
  return numbers;
}

ObservedClip Read(const JointTable& rows, const Layout& layout) {
  ObservedClip clip;
  clip.format = "joint_table";
  clip.joints = layout.joints;
  clip.frames = rows.frames / layout.rows_per_frame;
  clip.positions = JointPositions(clip.frames, clip.joints);
  clip.confidence.assign(static_cast<std::size_t>(clip.frames) * clip.joints, 0.0);
  clip.zeros.assign(clip.confidence.size(), 0);
  const int per_row = layout.joints / layout.rows_per_frame;
  for (int f = 0; f < clip.frames; ++f) {
    for (int j = 0; j < clip.joints; ++j) {
      const int row = f * layout.rows_per_frame + j / per_row;
      const int column = layout.x_columns.empty() ? layout.first_column + (j % per_row) * layout.columns_per_joint
                                                  : layout.x_columns[j];
      const auto number = [&](int axis) { return rows.at(row, 0, column + layout.axis[axis]); };
      const Vector3d value(number(0), number(1), number(2));
      const std::size_t at =
          static_cast<std::size_t>(f) * static_cast<std::size_t>(clip.joints) + static_cast<std::size_t>(j);
      clip.zeros[at] = value.isZero(0.0) ? 1 : 0;
      if (!value.allFinite() || value.isZero(0.0)) continue;
      clip.positions.at(f, j) = value;
      clip.confidence[at] = 1.0;
    }
  }
  clip.frame_numbers = FrameNumbers(rows, layout);
  clip.layout_evidence = layout.words;
  AddLayoutFacts(rows, layout, clip);
  return clip;
}

/// CAD-60: frame number; 11 joints with 9 orientation values, their confidence, x y z, confidence; 4 joints without.
Layout Cad60Layout() {
  Layout layout{15, 1, 0, 3, {}, "171 numbers a row: frame number, 11 joints with orientation, 4 without (CAD-60)"};
  for (int j = 0; j < 11; ++j) layout.x_columns.push_back(1 + 14 * j + 10);
  for (int j = 0; j < 4; ++j) layout.x_columns.push_back(1 + 14 * 11 + 4 * j);
  return layout;
}

std::string RowWords(int rows, int joints, int columns) {
  return std::to_string(rows) + " rows of " + std::to_string(columns) + " numbers = " + std::to_string(rows / joints) +
         " frames of " + std::to_string(joints) + " joints, one a row";
}

/// Every way to read the table that its counts allow.
std::vector<Layout> PossibleLayouts(int rows, int columns) {
  std::vector<Layout> layouts;
  if (columns == 171) layouts.push_back(Cad60Layout());
  if (columns == 3 || columns == 4) {
    for (int joints = kFewestJoints; joints <= kMostJoints; ++joints) {
      if (rows % joints == 0) layouts.push_back({joints, joints, 0, columns, {}, RowWords(rows, joints, columns)});
    }
    return layouts;
  }
  for (const int leading : {0, 1}) {
    for (const int per_joint : {3, 4}) {
      const int rest = columns - leading;
      const int joints = rest / per_joint;
      if (rest % per_joint != 0 || joints < kFewestJoints || joints > kMostJoints) continue;
      layouts.push_back({joints,
                         1,
                         leading,
                         per_joint,
                         {},
                         "rows of " + std::to_string(columns) + " numbers: one frame of " + std::to_string(joints) +
                             " joints with " + std::to_string(per_joint) + " each" +
                             (leading > 0 ? " after one leading number" : "")});
    }
  }
  return layouts;
}

/// Median step of a joint between frames against the size of the body: small when frames are cut at the right rows.
double Roughness(const ObservedClip& clip) {
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
  const auto median = [](std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  const double size = median(sizes);
  return size > 0.0 ? median(steps) / size : 1.0;
}

bool IsKnownCount(int joints) {
  const std::vector<JointOrder>& orders = KnownJointOrders();
  return std::any_of(orders.begin(), orders.end(),
                     [&](const JointOrder& order) { return static_cast<int>(order.joints.size()) == joints; });
}

/// The surest reading in a known order; a remark names the other counts that fit.
std::optional<ObservedClip> KnownReading(const JointTable& rows, const std::vector<Layout>& layouts) {
  std::optional<ObservedClip> best;
  std::string others;
  for (const Layout& layout : layouts) {
    if (!IsKnownCount(layout.joints)) continue;
    ObservedClip clip = Read(rows, layout);
    if (!RecogniseOrder(clip) || Roughness(clip) > kSmooth) continue;
    const bool better = !best || clip.skeleton_confidence > best->skeleton_confidence;
    if (best) {
      others += (others.empty() ? "" : ", ") + std::to_string(better ? best->joints : clip.joints);
    }
    if (better) best = std::move(clip);
  }
  if (best && !others.empty()) {
    best->remarks.push_back({"layout_ambiguous", Severity::kWarning, best->skeleton_confidence,
                             "the row count also allows " + others + " joints, and bone lengths do not exclude it"});
  }
  return best;
}

/// The best reading: a known order that fits, else the smoothest one.
Expected<ObservedClip> BestReading(const JointTable& rows, const std::string& name) {
  if (std::all_of(rows.values.begin(), rows.values.end(), [](double value) { return value == 0.0; })) {
    return Fail(ErrorCode::kInconsistent, "every number is zero: no joint is seen in any frame", name,
                "the tracker lost the person: leave the file out");
  }
  const std::vector<Layout> layouts = PossibleLayouts(rows.frames, rows.columns);
  if (std::optional<ObservedClip> known = KnownReading(rows, layouts)) return std::move(*known);
  std::optional<ObservedClip> smoothest;
  double least_rough = kSmooth;
  for (const Layout& layout : layouts) {
    ObservedClip clip = Read(rows, layout);
    const double roughness = Roughness(clip);
    if (roughness >= least_rough) continue;
    least_rough = roughness;
    smoothest = std::move(clip);
  }
  if (!smoothest) {
    return Fail(ErrorCode::kUnsupported,
                std::to_string(rows.frames) + " rows of " + std::to_string(rows.columns) +
                    " numbers are read as no table of joints",
                name, "declare rows_per_frame, columns and joints in a source (--source CONFIG)");
  }
  RecogniseOrder(*smoothest);  // for what it says of the orders
  if (Rigidity(smoothest->positions, smoothest->confidence) > kRigid) DoubtPositions(*smoothest);
  smoothest->remarks.push_back({"layout_unknown", Severity::kWarning, least_rough,
                                "no known order of joints fits; " + std::to_string(smoothest->joints) +
                                    " joints a frame give the smoothest motion"});
  return std::move(*smoothest);
}

Expected<ObservedClip> DeclaredReading(const JointTable& rows, const SourceOptions& source, const std::string& name) {
  Layout layout;
  layout.joints = static_cast<int>(source.joints.size());
  layout.rows_per_frame = source.rows_per_frame > 0 ? static_cast<int>(source.rows_per_frame) : layout.joints;
  layout.columns_per_joint = static_cast<int>(source.columns.size());
  const int per_row = layout.rows_per_frame > 0 ? layout.joints / layout.rows_per_frame : 0;
  if (per_row < 1 || rows.columns != per_row * layout.columns_per_joint || rows.frames % layout.rows_per_frame != 0) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(rows.frames) + " rows of " + std::to_string(rows.columns) +
                    " numbers are not what the source declares: frames of " + std::to_string(layout.rows_per_frame) +
                    " rows with " + std::to_string(per_row * layout.columns_per_joint) + " numbers",
                name, "mend rows_per_frame, columns or joints, or the file is cut off");
  }
  const auto place = [&](const char* column) {
    return static_cast<int>(std::find(source.columns.begin(), source.columns.end(), column) - source.columns.begin());
  };
  for (int axis = 0; axis < 3; ++axis) layout.axis[axis] = place(kAxisColumns[axis]);
  const int confidence = place("confidence");
  layout.words = "as declared: " + RowWords(rows.frames, layout.rows_per_frame, rows.columns);
  ObservedClip clip = Read(rows, layout);
  if (confidence < layout.columns_per_joint) {
    for (int f = 0; f < clip.frames; ++f) {
      for (int j = 0; j < clip.joints; ++j) {
        const int row = f * layout.rows_per_frame + j / per_row;
        const double value = rows.at(row, 0, (j % per_row) * layout.columns_per_joint + confidence);
        const std::size_t at =
            static_cast<std::size_t>(f) * static_cast<std::size_t>(clip.joints) + static_cast<std::size_t>(j);
        if (value > 0.0 || source.least_confidence > 0.0) continue;
        clip.confidence[at] = 0.0;
        clip.zeros[at] = 0;
      }
    }
  }
  if (source.missing == MissingValue::kZero) clip.zeros.clear();
  DeclareOrder(source, clip);
  return clip;
}

void AddRemarks(const std::vector<Finding>& findings, ObservedClip& clip) {
  for (const Finding& finding : findings)
    clip.remarks.push_back({finding.code, finding.severity, finding.value, finding.message});
}

/// By `layout`, as an ingest reads it.
Expected<ObservedClip> LayoutReading(std::string_view bytes, const SourceOptions& source, const std::string& name) {
  const Expected<JointLayout> layout = TableLayout(source);
  if (!layout) return Forward(layout);
  if (layout->Joints() != static_cast<int>(source.joints.size())) {
    return Fail(ErrorCode::kInconsistent,
                "ingest.source.layout has " + std::to_string(layout->Joints()) + " joints, " +
                    std::to_string(source.joints.size()) + " are named under ingest.source.joints",
                name, "name each joint of the layout, in its order");
  }
  JointTableLayout table;
  table.rows_per_frame = RowsPerFrame(source);
  table.allow_nan = source.missing == MissingValue::kNan;
  table.damaged_rows = source.damaged_rows;
  table.end_word = source.end_word;
  const Expected<JointRows> rows = ParseJointRows(bytes, *layout, table, name);
  if (!rows) return Forward(rows);
  ObservedClip clip;
  clip.format = "joint_table";
  clip.frames = rows->frames;
  clip.joints = rows->joints;
  clip.positions = JointPositions(clip.frames, clip.joints);
  const std::size_t samples = static_cast<std::size_t>(clip.frames) * static_cast<std::size_t>(clip.joints);
  clip.confidence.assign(samples, 0.0);
  clip.zeros.assign(samples, 0);
  for (std::size_t at = 0; at < samples; ++at) {
    const Vector3d value(rows->position[at * 3], rows->position[at * 3 + 1], rows->position[at * 3 + 2]);
    const bool doubted = !rows->confidence.empty() && !(rows->confidence[at] > 0.0) && source.least_confidence <= 0.0;
    clip.zeros[at] = value.isZero(0.0) && !doubted ? 1 : 0;
    if (!value.allFinite() || value.isZero(0.0)) continue;
    clip.positions.at(static_cast<int>(at) / clip.joints, static_cast<int>(at) % clip.joints) = value;
    clip.confidence[at] = doubted ? 0.0 : 1.0;
  }
  if (source.missing == MissingValue::kZero) clip.zeros.clear();
  clip.layout_evidence = "as declared: " + source.layout;
  clip.facts.emplace_back("layout", source.layout);
  DeclareOrder(source, clip);
  AddRemarks(rows->findings, clip);
  return clip;
}

/// Rows that damage or a cut does not shift: each stands in its place, a damaged one without numbers.
Expected<JointTable> WholeRows(std::string_view bytes, JointTableLayout layout, const std::string& name) {
  std::vector<double> first;
  NumberScanner scanner(bytes, true);
  while (first.empty() && scanner.Numbers(first) == NumberScanner::Token::kLineEnd) continue;
  layout.damaged_rows = DamagedRows::kReport;
  layout.columns = static_cast<int>(first.size());
  return ParseJointTable(bytes, layout, name);
}

/// A table whose last frame is not whole, by the orders that are known.
Expected<ObservedClip> CutReading(const JointTable& rows, const std::string& name, Expected<ObservedClip> otherwise) {
  for (const int joints : {15, 20, 25}) {
    const int left_over = rows.frames % joints;
    if (left_over == 0 || rows.frames < 2 * joints) continue;
    JointTable whole = rows;
    whole.frames -= left_over;
    whole.values.resize(static_cast<std::size_t>(whole.frames) * static_cast<std::size_t>(whole.columns));
    Expected<ObservedClip> clip = BestReading(whole, name);
    if (!clip || clip->skeleton.empty()) continue;
    clip->remarks.push_back({"cut_off", Severity::kError, static_cast<double>(left_over),
                             "the file is cut off: " + std::to_string(left_over) + " of the " + std::to_string(joints) +
                                 " rows of a last frame stand at its end"});
    return clip;
  }
  return otherwise;
}

}  // namespace

Expected<std::vector<ObservedClip>> ObserveTable(std::string_view bytes, const std::string& name,
                                                 const std::optional<SourceOptions>& source) {
  if (!source || source->format == SourceFormat::kExpmap) {
    if (std::optional<ObservedClip> rotations = ObserveExpmap(bytes, name))
      return std::vector<ObservedClip>{std::move(*rotations)};
  }
  const bool by_layout =
      source && source->format == SourceFormat::kJointTable && !source->joints.empty() && !source->layout.empty();
  JointTableLayout layout;
  layout.allow_nan = !source || source->format != SourceFormat::kJointTable || source->missing == MissingValue::kNan;
  layout.end_word = "END";
  Expected<JointTable> rows = ParseJointTable(bytes, layout, name);
  const bool damaged = !rows.has_value();
  if (damaged) {
    Expected<JointTable> kept = WholeRows(bytes, layout, name);
    if (!kept) return Forward(rows);
    rows = std::move(kept);
  }
  const bool declared = source && source->format == SourceFormat::kJointTable && !source->joints.empty() &&
                        std::all_of(std::begin(kAxisColumns), std::end(kAxisColumns), [&](const char* column) {
                          return std::count(source->columns.begin(), source->columns.end(), column) == 1;
                        });
  const bool reports = declared && source->damaged_rows == DamagedRows::kReport && source->least_confidence == 0.0;
  const bool cut = reports && rows->frames > RowsPerFrame(*source) && rows->frames % RowsPerFrame(*source) != 0;
  const bool as_ingested = by_layout || cut || (reports && damaged);
  Expected<ObservedClip> clip = as_ingested ? LayoutReading(bytes, *source, name)
                                : declared  ? DeclaredReading(*rows, *source, name)
                                            : BestReading(*rows, name);
  if (!clip && !source) clip = CutReading(*rows, name, std::move(clip));
  if (!clip) return Forward(clip);
  if (damaged && !as_ingested) AddRemarks(rows->findings, *clip);
  if (bytes.find("\nEND") != std::string_view::npos) clip->facts.emplace_back("end_word", "END");
  if (std::none_of(clip->confidence.begin(), clip->confidence.end(), [](double c) { return c > 0.0; })) {
    clip->remarks.push_back({"no_joint_seen", Severity::kError, 1.0, "every joint of every frame is missing"});
  }
  return std::vector<ObservedClip>{std::move(*clip)};
}

}  // namespace mocurate
