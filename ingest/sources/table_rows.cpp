#include "ingest/sources/table_rows.h"

#include <algorithm>

#include "core/base/text.h"
#include "core/formats/number_scanner.h"
#include "core/quality/tracked_points.h"
#include "ingest/inspect/joint_orders.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

constexpr int kFewestTableFrames = 8;  // fewer do not determine the order of joints

/// Whether the last whole frames are a body in the declared order, as the others are. Too few frames count as no body.
bool EndsAsBody(const JointRows& rows, const SourceOptions& source) {
  const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  if (!skeleton || !*skeleton || rows.frames < kFewestTableFrames) return true;
  const std::vector<RawBone> bones = BonesOf(source.joints, **skeleton);
  for (const int frames : {rows.frames, kFewestTableFrames}) {
    JointPositions positions(frames, rows.joints);
    std::vector<double> confidence;
    const std::size_t first = static_cast<std::size_t>(rows.frames - frames) * static_cast<std::size_t>(rows.joints);
    for (std::size_t at = 0; at < positions.xyz.size() / 3; ++at) {
      const Vector3d point(&rows.position[3 * (first + at)]);
      confidence.push_back(point.allFinite() && !point.isZero(0.0) ? 1.0 : 0.0);
      if (confidence.back() > 0.0) std::copy_n(point.data(), 3, &positions.xyz[3 * at]);
    }
    if (!ScoreBody(positions, confidence, bones).IsBody()) return false;
  }
  return true;
}

std::string RowCountProblem(const JointRows& rows, int per_frame) {
  const long long count = static_cast<long long>(rows.frames) * per_frame + rows.rows_left_over;
  const int missing = per_frame - rows.rows_left_over;
  return std::to_string(count) + " rows are not a whole number of frames of " + std::to_string(per_frame) +
         " rows: " + Counted(missing, "row") + (missing == 1 ? " is" : " are") + " missing, or " +
         std::to_string(rows.rows_left_over) + " too many";
}

}  // namespace

Finding DecimalCommas() {
  return MakeFinding("decimal_comma", Severity::kInfo, 0.0, "numbers have a decimal comma (1,5); it is read as a point",
                     FindingAction::kRepaired);
}

Expected<JointRows> ReadTableRows(const SourceOptions& source, std::string_view bytes, const std::string& name) {
  const Expected<std::optional<std::string>> points = WithDecimalPoints(bytes, name);
  if (!points) return Forward(points);
  if (*points) {
    Expected<JointRows> rows = ReadTableRows(source, **points, name);
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
  Expected<JointRows> rows = ParseJointRows(bytes, *layout, table, name, source.rate_hz.value_or(0.0));
  if (!rows || rows->rows_left_over == 0) return rows;
  // A file that is cut off is a body up to its end; after a lost or repeated row, joints get wrong names.
  if (EndsAsBody(*rows, source)) return rows;
  return Fail(ErrorCode::kInconsistent, RowCountProblem(*rows, table.rows_per_frame), name,
              "the joints stop forming a body before the end of the file: compare the file with its source, or "
              "correct ingest.source.rows_per_frame and joints");
}

}  // namespace mocurate
