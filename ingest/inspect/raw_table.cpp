#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/joint_table.h"
#include "core/formats/number_scanner.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/inspect/table_readings.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

/// A table of one joint a row that is cut off within a frame, in a known order.
std::optional<RawClip> TruncatedLayout(const JointTable& rows) {
  std::optional<RawClip> best;
  for (const int joints : {15, 20, 24, 25}) {
    const int left_over = rows.frames % joints;
    if (left_over == 0 || rows.frames < 2 * joints) continue;
    JointTable whole = rows;
    whole.frames -= left_over;
    whole.values.resize(static_cast<std::size_t>(whole.frames) * static_cast<std::size_t>(rows.columns));
    std::optional<RawClip> clip =
        KnownLayout(whole, {{joints, joints, 0, rows.columns, {}, RowWords(whole.frames, joints, rows.columns)}});
    if (!clip || (best && best->skeleton.confidence >= clip->skeleton.confidence)) continue;
    clip->remarks.push_back(MakeFinding("cut_off", Severity::kError, left_over,
                                        "the file is cut off: " + std::to_string(left_over) + " of the " +
                                            std::to_string(joints) + " rows of its last frame are there"));
    best = std::move(clip);
  }
  return best;
}

/// The best reading: a known order that fits, else the smoothest one.
Expected<RawClip> BestLayout(const JointTable& rows, const std::string& name) {
  if (std::all_of(rows.values.begin(), rows.values.end(), [](double value) { return value == 0.0; })) {
    return Fail(ErrorCode::kInconsistent, "every number is zero: no joint is seen in any frame", name,
                "the tracker lost the person: leave the file out", Reason::kNoValidSamples);
  }
  const std::optional<RowLayout> counted = CountedLayout(rows);
  const std::vector<RowLayout> layouts = counted ? std::vector<RowLayout>{*counted} : PossibleLayouts(rows);
  if (std::optional<RawClip> known = KnownLayout(rows, layouts)) return std::move(*known);
  const bool joint_a_row = rows.columns == 3 || rows.columns == 4;
  if (std::optional<RawClip> cut = joint_a_row ? TruncatedLayout(rows) : std::nullopt) return std::move(*cut);
  std::optional<RawClip> smoothest;
  double least_rough = kSmooth;
  for (const RowLayout& layout : layouts) {
    RawClip clip = ReadRows(rows, layout);
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
  if (Rigidity(smoothest->positions, smoothest->confidence) > kRigid) CheckPositions(*smoothest);
  smoothest->remarks.push_back(MakeFinding(
      "layout_unknown", Severity::kWarning, least_rough,
      "no known order of joints fits; " + std::to_string(smoothest->joints) +
          " joints a frame give the smoothest motion, with steps of " + RoundedText(least_rough) + " of the body" +
          (smoothest->skeleton.evidence.empty() ? "" : "; " + smoothest->skeleton.evidence)));
  return std::move(*smoothest);
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

/// An undeclared column that is read as confidence decides which joints are observed.
void ReportGuessedConfidence(RawClip& clip) {
  if (clip.guessed_share <= 0.0) return;
  clip.remarks.push_back(
      MakeFinding("confidence_guessed", Severity::kInfo, clip.guessed_share,
                  "the number behind x, y, z lies in 0 to 1 throughout: taken as a confidence, by which " +
                      RoundedText(100.0 * clip.guessed_share, 3) +
                      " % of the joints are not seen although they have a place; "
                      "ingest.source.least_confidence: 0.1 takes them as "
                      "seen, but doubted, and `skip` in the place of `confidence` (ingest.source.columns, "
                      "layout) passes the number "
                      "over"));
}

}  // namespace

Finding DecimalCommas() {
  return MakeFinding("decimal_comma", Severity::kInfo, 0.0, "numbers have a decimal comma (1,5); it is read as a point",
                     FindingAction::kRepaired);
}

Expected<RawFile> ReadRawTable(const FileBytes& file) {
  const auto& [bytes, name, path] = file;
  const Expected<std::optional<std::string>> points = WithDecimalPoints(bytes, name);
  if (!points) return Forward(points);
  if (*points) {
    Expected<RawFile> observed = ReadRawTable({**points, name, path});
    if (observed) observed->clips.front().remarks.push_back(DecimalCommas());
    return observed;
  }
  if (std::optional<RawClip> rotations = ReadRawExpmap(bytes, name)) return RawFile::Of(*std::move(rotations));
  JointTableLayout layout;
  layout.allow_nan = true;
  layout.end_word = "END";
  Expected<JointTable> rows = ParseJointTable(bytes, layout, name);
  const bool damaged = !rows.has_value();
  if (damaged) {
    Expected<JointTable> kept = WholeRows(bytes, layout, name);
    if (!kept) return Forward(rows);
    rows = std::move(kept);
  }
  Expected<RawClip> clip = BestLayout(*rows, name);
  if (!clip) return Forward(clip);
  if (damaged) {
    const int per_frame = std::max(1, rows->frames / std::max(1, clip->frames));
    for (Finding finding : rows->findings) {
      finding.frame_begin /= per_frame;
      finding.frame_end = (finding.frame_end + per_frame - 1) / per_frame;
      clip->remarks.push_back(std::move(finding));
    }
  }
  ReportGuessedConfidence(*clip);
  if (bytes.find("\nEND") != std::string_view::npos) clip->facts.emplace_back("end_word", "END");
  if (std::none_of(clip->confidence.begin(), clip->confidence.end(), [](double c) { return c > 0.0; })) {
    clip->remarks.push_back(
        MakeFinding("no_joint_seen", Severity::kError, static_cast<double>(clip->frames),
                    "no joint is seen in " + std::to_string(clip->frames) + " of " + Counted(clip->frames, "frame")));
  }
  return RawFile::Of(*std::move(clip));
}

}  // namespace mocurate
