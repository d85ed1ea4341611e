#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/decimal_comma.h"
#include "core/formats/joint_layout.h"
#include "core/formats/joint_table.h"
#include "core/formats/number_scanner.h"
#include "ingest/sense/observe.h"
#include "ingest/sense/remark.h"
#include "ingest/sense/table_readings.h"
#include "ingest/sources/source_file.h"
#include "ingest/sources/table_rows.h"

namespace mocurate {
namespace {

constexpr const char* kAxisColumns[] = {"x", "y", "z"};

/// The best reading: a known order that fits, else the smoothest one.
Expected<ObservedClip> BestReading(const JointTable& rows, const std::string& name) {
  if (std::all_of(rows.values.begin(), rows.values.end(), [](double value) { return value == 0.0; })) {
    return Fail(ErrorCode::kInconsistent, "every number is zero: no joint is seen in any frame", name,
                "the tracker lost the person: leave the file out", Reason::kNobodySeen);
  }
  const std::optional<RowLayout> counted = CountedLayout(rows);
  const std::vector<RowLayout> layouts =
      counted ? std::vector<RowLayout>{*counted} : PossibleLayouts(rows.frames, rows.columns);
  if (std::optional<ObservedClip> known = KnownReading(rows, layouts)) return std::move(*known);
  std::optional<ObservedClip> smoothest;
  double least_rough = kSmooth;
  for (const RowLayout& layout : layouts) {
    ObservedClip clip = ReadRows(rows, layout);
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
                                    " joints a frame give the smoothest motion, with steps of " +
                                    RoundedText(least_rough) + " of the body" +
                                    (smoothest->skeleton_evidence.empty() ? "" : "; " + smoothest->skeleton_evidence)});
  return std::move(*smoothest);
}

Expected<ObservedClip> DeclaredReading(const JointTable& rows, const SourceOptions& source, const std::string& name) {
  RowLayout layout;
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
  ObservedClip clip = ReadRows(rows, layout);
  clip.missing_share.reset();  // the declaration says what is missing
  clip.missing_evidence.clear();
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
  const Expected<JointRows> rows = ReadTableRows(source, bytes, name);
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
  if (source.layout.empty()) {
    std::string columns;
    for (const std::string& column : source.columns) columns += (columns.empty() ? "" : ", ") + column;
    const int per_frame = RowsPerFrame(source);
    clip.layout_evidence = "as declared: frames of " + Counted(per_frame, "row") + " with " + columns;
    clip.facts.emplace_back("columns", columns);
  } else {
    clip.layout_evidence = "as declared: " + source.layout;
    clip.facts.emplace_back("layout", source.layout);
  }
  DeclareOrder(source, clip);
  AddRemarks(rows->findings, clip);
  return clip;
}

/// Rows that damage or a cut does not shift: each stands in its place, a damaged one without numbers.
Expected<JointTable> WholeRows(std::string_view bytes, JointTableLayout layout, const std::string& name) {
  using Token = NumberScanner::Token;
  std::vector<double> first, row;
  NumberScanner scanner(bytes, true);
  for (Token token = Token::kLineEnd; token != Token::kEnd;) {
    row.clear();
    token = scanner.Numbers(row);
    const bool words = token != Token::kLineEnd && token != Token::kEnd;
    if (first.empty()) first = row;  // where no row is whole
    if (!words && row.size() > 2) {
      first = row;
      break;
    }
    // A header says nothing of the columns.
    while (token != Token::kLineEnd && token != Token::kEnd) token = scanner.Next();
  }
  layout.damaged_rows = DamagedRows::kReport;
  layout.columns = static_cast<int>(first.size());
  return ParseJointTable(bytes, layout, name);
}

/// A table of single rows as frames of `joints` rows.
JointTable InFrames(const JointTable& rows, int joints) {
  JointTable framed = rows;
  framed.findings.clear();
  framed.frames = rows.frames / joints;
  framed.rows_per_frame = joints;
  const auto whole = framed.values.begin() + static_cast<std::ptrdiff_t>(framed.frames) * joints * rows.columns;
  framed.left_over.assign(whole, framed.values.end());
  framed.values.erase(whole, framed.values.end());
  return framed;
}

/// What nobody declares and a reading takes for a confidence decides which joints are seen.
void TellGuessedConfidence(ObservedClip& clip) {
  if (clip.doubted_share <= 0.0) return;
  clip.remarks.push_back({"confidence_guessed", Severity::kInfo, clip.doubted_share,
                          "the number behind x, y, z lies in 0 to 1 throughout: taken as a confidence, by which " +
                              RoundedText(100.0 * clip.doubted_share, 3) +
                              " % of the joints are not seen although they have a place; "
                              "ingest.source.least_confidence: 0.1 takes them as "
                              "seen, but doubted, and `skip` in the place of `confidence` (ingest.source.columns, "
                              "layout) passes the number "
                              "over"});
}

/// Whether rows have another count of numbers than the source declares.
bool OtherColumns(const JointTable& rows, const SourceOptions& source) {
  const int per_row = static_cast<int>(source.joints.size()) / RowsPerFrame(source);
  return rows.columns != per_row * static_cast<int>(source.columns.size());
}

/// Whether a row is missing or too many for what the source declares, anywhere.
bool Shifted(const JointTable& rows, std::string_view bytes, const SourceOptions& source, const std::string& name) {
  const int per_frame = RowsPerFrame(source);
  if (rows.frames % per_frame != 0) return rows.frames > per_frame;
  if (per_frame != static_cast<int>(source.joints.size())) return false;
  JointPerRow joints;
  joints.columns = rows.columns;
  for (int axis = 0; axis < 3; ++axis) {
    const auto column = std::find(source.columns.begin(), source.columns.end(), kAxisColumns[axis]);
    joints.xyz[axis] = static_cast<int>(column - source.columns.begin());
  }
  if (static_cast<int>(source.columns.size()) != rows.columns) return false;
  JointTable framed = InFrames(rows, per_frame);
  JointTableLayout said;
  said.damaged_rows = DamagedRows::kReport;
  return MendFrames(joints, OddFrame::kLast, bytes, said, name, framed) && !framed.findings.empty();
}

/// A table in which frames are not whole, by the orders that are known: rows missing or too many, or cut off.
std::optional<ObservedClip> MendedReading(const JointTable& rows, std::string_view bytes, const std::string& name) {
  if (rows.columns != 3 && rows.columns != 4) return std::nullopt;
  std::optional<ObservedClip> best;
  for (const int joints : {15, 20, 24, 25}) {
    const JointPerRow in_rows{rows.values.data(), rows.frames, rows.columns};
    if (rows.frames < 2 * joints || !MostRowsGoOn(in_rows, joints)) continue;
    for (const OddFrame odd : {OddFrame::kLast, OddFrame::kFirst}) {
      JointTable mended = InFrames(rows, joints);
      const int left_over = rows.frames % joints;
      JointTableLayout said;
      said.damaged_rows = DamagedRows::kReport;
      if (!MendFrames(in_rows, odd, bytes, said, name, mended)) continue;
      const bool cut = mended.findings.empty() && left_over != 0;
      if (mended.findings.empty() && (!cut || odd == OddFrame::kFirst)) continue;
      mended.frames *= joints;
      mended.rows_per_frame = 1;
      std::optional<ObservedClip> clip =
          KnownReading(mended, {{joints, joints, 0, rows.columns, {}, RowWords(mended.frames, joints, rows.columns)}});
      if (!clip || (best && best->skeleton_confidence >= clip->skeleton_confidence)) continue;
      AddRemarks(mended.findings, *clip);
      if (cut) {
        clip->remarks.push_back({"cut_off", Severity::kError, static_cast<double>(left_over),
                                 "the file is cut off: " + std::to_string(left_over) + " of the " +
                                     std::to_string(joints) + " rows of a last frame stand at its end"});
      }
      best = std::move(clip);
    }
  }
  return best;
}

}  // namespace

Expected<std::vector<ObservedClip>> ObserveTable(std::string_view bytes, const std::string& name,
                                                 const std::optional<SourceOptions>& source) {
  if (const std::optional<std::string> points = WithDecimalPoints(bytes)) {
    auto clips = ObserveTable(*points, name, source);
    if (clips) clips->front().remarks.push_back(RemarkOf(DecimalCommas()));
    return clips;
  }
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
  const bool as_ingested =
      by_layout || (declared && (damaged || OtherColumns(*rows, *source) || Shifted(*rows, bytes, *source, name)));
  Expected<ObservedClip> clip = as_ingested ? LayoutReading(bytes, *source, name)
                                : declared  ? DeclaredReading(*rows, *source, name)
                                            : BestReading(*rows, name);
  if (!source) {
    std::optional<ObservedClip> mended = MendedReading(*rows, bytes, name);
    if (mended && (!clip || clip->skeleton.empty() || clip->joints == mended->joints ||
                   mended->skeleton_confidence > clip->skeleton_confidence)) {
      clip = std::move(*mended);
    }
  }
  if (!clip) return Forward(clip);
  if (damaged && !as_ingested) AddRemarks(rows->findings, *clip, std::max(1, rows->frames / std::max(1, clip->frames)));
  if (!declared && !by_layout) TellGuessedConfidence(*clip);
  if (bytes.find("\nEND") != std::string_view::npos) clip->facts.emplace_back("end_word", "END");
  if (std::none_of(clip->confidence.begin(), clip->confidence.end(), [](double c) { return c > 0.0; })) {
    clip->remarks.push_back(
        {"no_joint_seen", Severity::kError, static_cast<double>(clip->frames),
         "no joint is seen in " + std::to_string(clip->frames) + " of " + Counted(clip->frames, "frame")});
  }
  return std::vector<ObservedClip>{std::move(*clip)};
}

}  // namespace mocurate
