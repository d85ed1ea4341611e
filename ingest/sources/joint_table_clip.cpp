#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/quality/tracked_points.h"
#include "ingest/sources/source_file.h"
#include "ingest/sources/table_rows.h"

namespace mocurate {
namespace {

bool IsMissing(const Vector3d& raw, MissingValue missing) {
  if (!raw.allFinite()) return true;
  return missing == MissingValue::kZero && raw.isZero(0.0);
}

constexpr double kNoRotation = 1e-2;  ///< departure of a written rotation's product with itself from the identity

/// The rotations that the file records, of points that it records one for. What is marked as sure and is no rotation is
/// taken for missing, with a finding.
void TakeRotations(const JointRows& rows, const SourceFrame& frame, JointTracks& tracks,
                   std::vector<Finding>& findings) {
  if (rows.rotation.empty()) return;
  tracks.rotation.assign(tracks.confidence.size(), Quaterniond::Identity());
  tracks.rotation_confidence.assign(tracks.confidence.size(), 0.0);
  const Matrix3d turn = frame.world_from_file;
  int malformed = 0;
  int first = 0;
  for (std::size_t at = 0; at < tracks.confidence.size(); ++at) {
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> written(rows.rotation.data() + 9 * at);
    const double confidence = rows.rotation_confidence.empty() ? 1.0 : rows.rotation_confidence[at];
    if (!(confidence > 0.0) || written.isZero(0.0) || written.hasNaN()) continue;  // NaN is told of its row
    const bool rotation = written.allFinite() && written.determinant() > 0.0 &&
                          (written.transpose() * written - Matrix3d::Identity()).cwiseAbs().maxCoeff() < kNoRotation;
    if (!rotation) {
      if (malformed++ == 0) first = static_cast<int>(at) / rows.joints;
      continue;
    }
    // A mirrored file mirrors the points' own frames too: which way these lie is the source's convention.
    tracks.rotation[at] = Quaterniond(Matrix3d(turn * written * turn.transpose())).normalized();
    tracks.rotation_confidence[at] = std::min(confidence, 1.0);
  }
  if (malformed == 0) return;
  findings.push_back(FrameFinding(
      "not_a_rotation", first, first + 1, "", malformed,
      Counted(malformed, "recorded rotation") + " marked as sure: the matrix is not orthogonal; taken for missing"));
}

}  // namespace

Expected<IngestedClip> ReadJointTableClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<SourceFrame> frame = FrameOf(source);
  if (!frame) return Forward(frame);
  Expected<JointRows> rows = ReadTableRows(source, file.bytes, file.name);
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
  TakeRotations(*rows, *frame, tracks, ingested.findings);
  if (zeros == tracks.confidence.size()) {
    return Fail(ErrorCode::kInconsistent, "every joint of every frame is 0 0 0: no joint is seen", file.name,
                "the tracker never saw the person: leave the file out", Reason::kNobodySeen);
  }
  const bool any = std::any_of(tracks.confidence.begin(), tracks.confidence.end(), [](double c) { return c > 0.0; });
  if (!any) {
    return Fail(ErrorCode::kInconsistent, "no joint is seen at all in " + Counted(rows->frames, "frame"), file.name,
                "the tracker lost the person: leave the file out", Reason::kNobodySeen);
  }
  NoteEmptyFrames(tracks, ingested.findings);
  ingested.clip.evidence.tracks = std::move(tracks);
  return ingested;
}

}  // namespace mocurate
