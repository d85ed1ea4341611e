#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/formats/joint_layout.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

bool IsMissing(const Vector3d& raw, MissingValue missing) {
  if (!raw.allFinite()) return true;
  return missing == MissingValue::kZero && raw.isZero(0.0);
}

}  // namespace

Expected<IngestedClip> ReadJointTableClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<SourceFrame> frame = FrameOf(source);
  if (!frame) return Forward(frame);
  const Expected<JointLayout> layout = TableLayout(source);
  if (!layout) return Forward(layout);
  JointTableLayout table;
  table.rows_per_frame = RowsPerFrame(source);
  table.allow_nan = source.missing == MissingValue::kNan;
  table.damaged_rows = source.damaged_rows;
  table.end_word = source.end_word;
  Expected<JointRows> rows = ParseJointRows(file.bytes, *layout, table, file.name);
  if (!rows) return Forward(rows);

  IngestedClip ingested;
  ingested.findings = std::move(rows->findings);
  ingested.clip.rate = FrameRate::FromHz(*source.rate_hz);
  JointTracks tracks;
  tracks.names = source.joints;
  tracks.positions = JointPositions(rows->frames, rows->joints);
  tracks.confidence.assign(static_cast<std::size_t>(rows->frames) * rows->joints, 0.0);
  std::size_t zeros = 0;
  for (int f = 0; f < rows->frames; ++f) {
    tracks.time_s.push_back(ingested.clip.rate.FrameTime(f));
    for (int j = 0; j < rows->joints; ++j) {
      const std::size_t at = static_cast<std::size_t>(f) * rows->joints + j;
      const Vector3d raw(rows->position[at * 3], rows->position[at * 3 + 1], rows->position[at * 3 + 2]);
      double confidence = rows->confidence.empty() ? 1.0 : rows->confidence[at];
      if (confidence < 0.0 || confidence > 1.0) {
        return Fail(ErrorCode::kInconsistent,
                    "confidence " + FormatDouble(confidence) + " of joint '" +
                        source.joints[static_cast<std::size_t>(j)] + "' in frame " + std::to_string(f) +
                        " is not in 0..1",
                    file.name, "write `skip` for that column, or bring it to 0..1 first");
      }
      confidence = std::max(confidence, source.least_confidence);
      if (std::isnan(confidence) || IsMissing(raw, source.missing)) confidence = 0.0;
      tracks.confidence[at] = confidence;
      zeros += confidence > 0.0 && raw.isZero(0.0) ? 1 : 0;
      if (confidence > 0.0) tracks.positions.at(f, j) = frame->metres_from_file * raw;
    }
  }
  if (zeros == tracks.confidence.size()) {
    return Fail(ErrorCode::kInconsistent, "every joint of every frame is 0 0 0", file.name,
                "the tracker never saw the person: leave the file out");
  }
  const bool any = std::any_of(tracks.confidence.begin(), tracks.confidence.end(), [](double c) { return c > 0.0; });
  if (!any) {
    return Fail(ErrorCode::kInconsistent, "no joint is seen at all in " + Counted(rows->frames, "frame"), file.name,
                "the tracker lost the person: leave the file out");
  }
  NoteEmptyFrames(tracks, ingested.findings);
  ingested.clip.evidence.tracks = std::move(tracks);
  return ingested;
}

}  // namespace mocurate
