#include <algorithm>

#include "core/base/text.h"
#include "core/formats/phspd_text.h"
#include "core/quality/tracked_points.h"
#include "ingest/sources/smpl_motion.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

constexpr int kLongestGap = 10000;  // frames; a recording of minutes has some thousands

/// "time_gap" of frames without a row, which are missing; of rows that were damaged it is told already.
void NoteGaps(const PhspdPose& pose, std::vector<Finding>& findings) {
  for (std::size_t i = 1; i < pose.frame.size(); ++i) {
    const int first = pose.frame.front(), before = pose.frame[i - 1], after = pose.frame[i];
    const auto damaged = std::count_if(findings.begin(), findings.end(), [&](const Finding& finding) {
      return finding.action == "dropped" && finding.frame_begin > before - first && finding.frame_begin < after - first;
    });
    const int skipped = after - before - 1 - static_cast<int>(damaged);
    if (skipped <= 0) continue;
    findings.push_back(FrameFinding("time_gap", before + 1 - first, after - first, "", skipped,
                                    Counted(skipped, "frame") + " without a row: " + std::to_string(before) +
                                        " is followed by " + std::to_string(after)));
    findings.back().action = "dropped";
  }
}

}  // namespace

Expected<IngestedClip> ReadPhspdClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<AxisConvention> axes = AxisConvention::Parse(source.axes);
  if (!axes) return Forward(axes);
  const Expected<SkeletonPtr> skeleton = LoadSkeleton("smpl24");
  if (!skeleton) return Forward(skeleton);
  const Expected<std::vector<int>> columns = SmplColumns(**skeleton, kSmplJoints);
  if (!columns) return Forward(columns);
  const Expected<PhspdPose> pose = ParsePhspdPose(file.bytes, file.name, source.damaged_rows);
  if (!pose) return Forward(pose);
  if (pose->frame.empty()) return Fail(ErrorCode::kInconsistent, "the file has no frame", file.name);

  const int first = pose->frame.front();
  for (std::size_t i = 1; i < pose->frame.size(); ++i) {
    if (pose->frame[i] - pose->frame[i - 1] <= kLongestGap) continue;
    return Fail(ErrorCode::kInconsistent,
                "frame " + std::to_string(pose->frame[i]) + " follows " + std::to_string(pose->frame[i - 1]), file.name,
                "a gap of more than " + std::to_string(kLongestGap) + " frames is no recording");
  }
  const int frames = pose->frame.back() - first + 1;
  IngestedClip ingested;
  ingested.clip.rate = FrameRate::FromHz(*source.rate_hz);
  JointTracks tracks;
  tracks.positions = JointPositions(frames, kPhspdJoints);
  tracks.confidence.assign(static_cast<std::size_t>(frames) * kPhspdJoints, 0.0);
  for (const Joint& joint : (*skeleton)->joints) tracks.names.push_back(joint.name);
  for (int f = 0; f < frames; ++f) tracks.time_s.push_back(ingested.clip.rate.FrameTime(f));
  for (Finding finding : pose->findings) {
    finding.frame_begin = std::max(0, finding.frame_begin - first);
    finding.frame_end = std::max(finding.frame_begin, finding.frame_end - first);
    ingested.findings.push_back(std::move(finding));
  }
  for (std::size_t i = 0; i < pose->frame.size(); ++i) {
    const int f = pose->frame[i] - first;
    for (int j = 0; j < kPhspdJoints; ++j) {
      const double* place = &pose->position_m[i * 3 * kPhspdJoints + static_cast<std::size_t>((*columns)[j])];
      const Vector3d point(place[0], place[1], place[2]);
      if (!point.allFinite()) continue;
      tracks.positions.at(f, j) = axes->canonical_from_source * point;
      tracks.confidence[static_cast<std::size_t>(f) * kPhspdJoints + j] = 1.0;
    }
  }
  NoteGaps(*pose, ingested.findings);
  NoteEmptyFrames(tracks, ingested.findings);
  ingested.clip.provenance["first_frame"] = std::to_string(first);
  ingested.clip.evidence.tracks = std::move(tracks);
  return ingested;
}

}  // namespace mocurate
