#include "ingest/sources/table_rows.h"

#include <algorithm>

#include "core/base/text.h"
#include "core/formats/decimal_comma.h"
#include "core/quality/tracked_points.h"
#include "ingest/sense/joint_orders.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

constexpr int kFewestTableFrames = 8;  // fewer tell nothing about the order of joints

constexpr double kMuchBetterReading = 0.7;  // of two readings of one table, before the less usual one is believed

/// How body-like the rows are in the declared order; nothing where the declaration or the rows do not tell.
std::optional<BodyScore> ScoreRows(const JointRows& rows, const SourceOptions& source) {
  const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  if (!skeleton || rows.frames < kFewestTableFrames) return std::nullopt;
  if (static_cast<int>(source.joints.size()) != rows.joints) return std::nullopt;
  JointPositions positions(rows.frames, rows.joints);
  std::vector<double> confidence(static_cast<std::size_t>(rows.frames) * static_cast<std::size_t>(rows.joints), 0.0);
  for (std::size_t at = 0; at < confidence.size(); ++at) {
    const Vector3d point(rows.position[at * 3], rows.position[at * 3 + 1], rows.position[at * 3 + 2]);
    if (!point.allFinite() || point.isZero(0.0)) continue;
    confidence[at] = 1.0;
    positions.at(static_cast<int>(at) / rows.joints, static_cast<int>(at) % rows.joints) = point;
  }
  return ScoreBody(positions, confidence, BonesOf(source.joints, **skeleton));
}

std::string CountWords(const JointRows& rows, int per_frame) {
  const long long count = static_cast<long long>(rows.frames) * per_frame + rows.rows_left_over;
  const int missing = per_frame - rows.rows_left_over;
  return std::to_string(count) + " rows are no whole number of frames of " + std::to_string(per_frame) +
         " rows: " + Counted(missing, "row") + (missing == 1 ? " is" : " are") + " missing, or " +
         std::to_string(rows.rows_left_over) + " too many";
}

}  // namespace

Finding DecimalCommas() {
  Finding finding =
      FrameFinding("decimal_comma", 0, 0, "", 0.0, "numbers have a decimal comma (1,5): it is read as a point");
  finding.severity = Severity::kInfo;
  finding.action = FindingAction::kRepaired;
  return finding;
}

Expected<JointRows> ReadTableRows(const SourceOptions& source, std::string_view bytes, const std::string& name) {
  if (const std::optional<std::string> points = WithDecimalPoints(bytes)) {
    Expected<JointRows> rows = ReadTableRows(source, *points, name);
    if (rows) rows->findings.push_back(DecimalCommas());
    return rows;
  }
  const Expected<JointLayout> layout = TableLayout(source);
  if (!layout) return Forward(layout);
  JointTableLayout table;
  table.rows_per_frame = RowsPerFrame(source);
  table.allow_nan = source.missing == MissingValue::kNan;
  table.damaged_rows = source.damaged_rows;
  table.end_word = source.end_word;
  Expected<JointRows> rows = ParseJointRows(bytes, *layout, table, name);
  if (!rows || rows->rows_left_over == 0) return rows;
  const std::optional<BodyScore> cut = ScoreRows(*rows, source);
  if (!cut) return rows;
  Expected<JointRows> odd_first = ParseJointRows(bytes, *layout, table, name, OddFrame::kFirst);
  if (!odd_first) return rows;
  const std::optional<BodyScore> first = ScoreRows(*odd_first, source);
  if (first && first->IsBody() && first->total() < kMuchBetterReading * cut->total()) return odd_first;
  if (cut->IsBody()) return rows;
  return Fail(ErrorCode::kInconsistent, CountWords(*rows, table.rows_per_frame), name,
              "neither where joints go on nor the lengths of bones tell which: compare the file with its source, or "
              "mend ingest.source.rows_per_frame and joints");
}

}  // namespace mocurate
