#include "ingest/sources/phspd_tracks.h"

#include <algorithm>

#include "core/base/text.h"
#include "core/formats/phspd_text.h"
#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

constexpr int kLongestGap = 10000;  // frames; a recording of minutes has some thousands

/// "time_gap" of frames without a row, which become missing; damaged rows are reported already.
void NoteGaps(const PhspdPose& pose, std::vector<Finding>& findings) {
  for (std::size_t i = 1; i < pose.frame.size(); ++i) {
    const int first = pose.frame.front(), before = pose.frame[i - 1], after = pose.frame[i];
    const auto damaged = std::count_if(findings.begin(), findings.end(), [&](const Finding& finding) {
      return finding.action == FindingAction::kDropped && finding.frame_begin > before - first &&
             finding.frame_begin < after - first;
    });
    const int skipped = after - before - 1 - static_cast<int>(damaged);
    if (skipped <= 0) continue;
    findings.push_back(FrameFinding("time_gap", before + 1 - first, after - first, "", skipped,
                                    Counted(skipped, "frame") + " without a row: " + std::to_string(before) +
                                        " is followed by " + std::to_string(after)));
    findings.back().action = FindingAction::kDropped;
  }
}

}  // namespace

Expected<PhspdTracks> ReadPhspdTracks(std::string_view bytes, const std::string& name, DamagedRows damaged) {
  const Expected<PhspdPose> pose = ParsePhspdPose(bytes, name, damaged);
  if (!pose) return Forward(pose);
  if (pose->frame.empty()) return Fail(ErrorCode::kInconsistent, "the file has no frame", name);
  const int first = pose->frame.front();
  for (std::size_t i = 1; i < pose->frame.size(); ++i) {
    if (pose->frame[i] - pose->frame[i - 1] <= kLongestGap) continue;
    return Fail(ErrorCode::kInconsistent,
                "frame " + std::to_string(pose->frame[i]) + " follows " + std::to_string(pose->frame[i - 1]), name,
                "check the file: a gap of more than " + std::to_string(kLongestGap) + " frames is refused");
  }
  const int frames = pose->frame.back() - first + 1;
  PhspdTracks tracks;
  tracks.first_frame = first;
  tracks.positions = JointPositions(frames, kPhspdJoints);
  tracks.confidence.assign(static_cast<std::size_t>(frames) * kPhspdJoints, 0.0);
  for (Finding finding : pose->findings) {
    finding.frame_begin = std::max(0, finding.frame_begin - first);
    finding.frame_end = std::max(finding.frame_begin, finding.frame_end - first);
    tracks.findings.push_back(std::move(finding));
  }
  for (std::size_t i = 0; i < pose->frame.size(); ++i) {
    const int f = pose->frame[i] - first;
    for (int j = 0; j < kPhspdJoints; ++j) {
      const Vector3d point(&pose->position_m[(i * kPhspdJoints + static_cast<std::size_t>(j)) * 3]);
      if (!point.allFinite()) continue;
      tracks.positions.at(f, j) = point;
      tracks.confidence[static_cast<std::size_t>(f) * kPhspdJoints + static_cast<std::size_t>(j)] = 1.0;
    }
  }
  NoteGaps(*pose, tracks.findings);
  return tracks;
}

}  // namespace mocurate
