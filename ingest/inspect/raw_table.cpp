#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/joint_table.h"
#include "core/formats/number_scanner.h"
#include "ingest/formats/joint_table.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/inspect/table_readings.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

/// A table of one joint a row that is cut off within a frame, in a known order.
std::optional<TableReading> TruncatedLayout(const JointTable& rows) {
  std::optional<TableReading> best;
  for (const int joints : {15, 20, 24, 25}) {
    const int left_over = rows.frames % joints;
    if (left_over == 0 || rows.frames < 2 * joints) continue;
    JointTable whole = rows;
    whole.frames -= left_over;
    whole.values.resize(static_cast<std::size_t>(whole.frames) * static_cast<std::size_t>(rows.columns));
    std::vector<RowLayout> layouts = PossibleLayouts(whole);
    layouts.erase(std::remove_if(layouts.begin(), layouts.end(),
                                 [&](const RowLayout& layout) { return layout.joints != joints; }),
                  layouts.end());
    std::optional<TableReading> reading = KnownLayout(whole, layouts);
    if (!reading || (best && best->clip.skeleton.confidence >= reading->clip.skeleton.confidence)) continue;
    best = std::move(reading);
  }
  return best;
}

/// Whether all numbers of a column lie in 0..1, as confidences do.
bool LiesInUnitRange(const JointTable& rows, int column) {
  for (int row = 0; row < rows.frames; ++row) {
    const double value = rows.at(row, 0, column);
    if (!std::isnan(value) && !(value >= 0.0 && value <= 1.0)) return false;
  }
  return true;
}

/// What a header says, of which nothing is estimated but what its names leave open.
Expected<TableReading> NamedLayout(const JointTable& rows, std::vector<HeaderColumn> columns, const std::string& name) {
  const Expected<HeaderLayout> said = LayoutOfHeader(columns, name);
  if (!said) return Forward(said);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const bool sure = columns[c].word == "confidence";
    if (sure && !LiesInUnitRange(rows, static_cast<int>(c))) columns[c].word = kFillIn;  // of another scale
  }
  TableReading reading;
  reading.layout.joints = static_cast<int>(said->joints.size());
  reading.layout.columns = std::move(columns);
  reading.layout.words = "a header of " + Counted(reading.layout.joints, "joint");
  reading.clip = ReadPoints(rows, reading.layout);
  FollowFormat(said->skeleton, said->joints, "the header's names", reading.clip);
  reading.clip.units = said->units;
  reading.clip.joints_measured = false;
  return reading;
}

/// The best reading: what a header says, else a known order that fits, else the smoothest one.
Expected<TableReading> BestLayout(const JointTable& rows, const std::string& name) {
  if (std::all_of(rows.values.begin(), rows.values.end(), [](double value) { return value == 0.0; })) {
    return Fail(ErrorCode::kInconsistent, "every number is zero: no joint is seen in any frame", name,
                "the tracker lost the person: leave the file out", Reason::kNoValidSamples);
  }
  Expected<std::vector<HeaderColumn>> named = HeaderColumns(rows.header, rows.columns, name);
  if (!named) return Forward(named);
  if (!named->empty()) return NamedLayout(rows, *std::move(named), name);
  const auto leading = static_cast<std::size_t>(rows.columns % 3);  // a frame number or a time before the vectors
  NpyArray numbers{
      {static_cast<std::size_t>(rows.frames), static_cast<std::size_t>(rows.columns) - leading}, "", {}, {}};
  for (std::size_t at = 0; leading < 2 && at < rows.values.size(); ++at) {
    if (at % static_cast<std::size_t>(rows.columns) >= leading) numbers.values.push_back(rows.values[at]);
  }
  if (const std::string rotations = RotationsInstead(numbers, ""); !rotations.empty())
    return Fail(ErrorCode::kUnsupported, "the table holds " + rotations, name);
  const std::optional<RowLayout> counted = CountedLayout(rows);
  const std::vector<RowLayout> layouts = counted ? std::vector<RowLayout>{*counted} : PossibleLayouts(rows);
  std::optional<TableReading> known = KnownLayout(rows, layouts);
  if (known && known->layout.second_person) {
    return Fail(ErrorCode::kUnsupported, "each row holds two people of " + Counted(known->clip.joints, "joint"), name,
                "write a file for each, or declare a source of the first: ingest.source.layout: '" +
                    known->layout.Text() + "'");
  }
  if (known) return *std::move(known);
  const bool joint_a_row = rows.columns == 3 || rows.columns == 4;
  if (std::optional<TableReading> cut = joint_a_row ? TruncatedLayout(rows) : std::nullopt) return *std::move(cut);
  std::optional<TableReading> smoothest;
  double least_rough = kSmooth;
  for (const RowLayout& layout : layouts) {
    RawClip clip = ReadPoints(rows, layout);
    const double roughness = Roughness(clip);
    if (roughness >= least_rough) continue;
    least_rough = roughness;
    smoothest = TableReading{layout, std::move(clip)};
  }
  if (!smoothest) {
    return Fail(ErrorCode::kUnsupported,
                std::to_string(rows.frames) + " rows of " + std::to_string(rows.columns) +
                    " numbers are read as no table of joints",
                name, "declare rows_per_frame, columns and joints in a source (--source CONFIG)");
  }
  RawClip& clip = smoothest->clip;
  RecogniseOrder(clip);  // for what it says of the orders
  if (Rigidity(clip.positions, clip.confidence) > kRigid) CheckPositions(clip);
  clip.remarks.push_back(MakeFinding("layout_unknown", Severity::kWarning, least_rough,
                                     "no known order of joints fits; " + std::to_string(clip.joints) +
                                         " joints a frame give the smoothest motion, with steps of " +
                                         RoundedText(least_rough) + " of the body" +
                                         (clip.skeleton.evidence.empty() ? "" : "; " + clip.skeleton.evidence)));
  return *std::move(smoothest);
}

/// What a source would declare of the reading.
SourceOptions DeclarationOf(const TableReading& reading, bool end_word) {
  SourceOptions source;
  source.format = "joint_table";
  source.layout = WithFilledIn(reading.layout.Text(), "skip");
  source.rows_per_frame = reading.layout.rows_per_frame;
  source.joints = reading.clip.names;
  if (source.joints.empty()) source.joints.assign(static_cast<std::size_t>(reading.layout.joints), "-");
  if (reading.clip.skeleton.value && KnownSkeleton(*reading.clip.skeleton.value))
    source.skeleton = *reading.clip.skeleton.value;
  source.units = reading.clip.units;
  source.missing = MissingValue::kNan;
  if (end_word) source.end_word = "END";
  return source;
}

/// The clip as a run reads it by the declaration that is proposed. Errors of ReadTableRows.
Status ReadAsProposed(std::string_view bytes, bool end_word, const std::string& name, TableReading& reading) {
  const Expected<JointRows> rows = ReadTableRows(DeclarationOf(reading, end_word), bytes, name);
  if (!rows) return Forward(rows);
  RawClip& clip = reading.clip;
  clip.TakePoints(rows->frames, rows->position);
  clip.AddRemarks(rows->findings);
  clip.CutDamagedEnds();
  if (rows->hz > 0.0) {
    clip.rate_hz = NearestUsualRate(rows->hz).value_or(std::round(1000.0 * rows->hz) / 1000.0);
    clip.rate_finding = CheckStatedRate(*clip.rate_hz, RateUnit::kFramesPerSecond, clip.rate_evidence);
  }
  return {};
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

/// A column that may be a confidence would decide which joints are observed.
void ReportGuessedConfidence(RawClip& clip) {
  if (clip.guessed_share <= 0.0) return;
  clip.remarks.push_back(
      MakeFinding("confidence_guessed", Severity::kInfo, clip.guessed_share,
                  "the number behind x, y, z lies in 0 to 1 throughout, as a confidence does: by it " +
                      RoundedText(100.0 * clip.guessed_share, 3) +
                      " % of the joints would not be seen although they have a place; nothing says what it is: declare "
                      "`confidence` (with ingest.source.least_confidence: 0.1 such joints are seen, but doubted) or "
                      "`skip`"));
}

}  // namespace

Finding DecimalCommas() {
  return MakeFinding("decimal_comma", Severity::kInfo, 0.0, "numbers have a decimal comma (1,5); it is read as a point",
                     FindingAction::kRepaired);
}

Expected<RawFile> ReadRawTable(const FileBytes& file) {
  const std::string_view bytes = file.bytes;
  const std::string& name = file.name;
  const Expected<std::optional<std::string>> points = WithDecimalPoints(bytes, name);
  if (!points) return Forward(points);
  if (*points) {
    Expected<RawFile> observed = ReadRawTable({**points, name, file.path});
    if (observed) observed->clips.front().remarks.push_back(DecimalCommas());
    return observed;
  }
  if (std::optional<RawClip> rotations = ReadRawExpmap(bytes, name)) return RawFile::Of(*std::move(rotations));
  JointTableLayout layout;
  layout.allow_nan = true;
  layout.end_word = "END";
  Expected<JointTable> rows = ParseJointTable(bytes, layout, name);
  if (!rows) {
    Expected<JointTable> kept = WholeRows(bytes, layout, name);
    if (!kept) return Forward(rows);
    rows = std::move(kept);
  }
  Expected<TableReading> reading = BestLayout(*rows, name);
  if (!reading) return Forward(reading);
  const bool end_word = bytes.find("\nEND") != std::string_view::npos;
  DeclareLayout(*rows, reading->layout, reading->clip);
  if (Status read = ReadAsProposed(bytes, end_word, name, *reading); !read) return Forward(read);
  RawClip* clip = &reading->clip;
  ReportGuessedConfidence(*clip);
  if (end_word) clip->facts.emplace_back("end_word", "END");
  if (std::none_of(clip->confidence.begin(), clip->confidence.end(), [](double c) { return c > 0.0; })) {
    clip->remarks.push_back(
        MakeFinding("no_joint_seen", Severity::kError, static_cast<double>(clip->frames),
                    "no joint is seen in " + std::to_string(clip->frames) + " of " + Counted(clip->frames, "frame")));
  }
  return RawFile::Of(std::move(reading->clip));
}

}  // namespace mocurate
