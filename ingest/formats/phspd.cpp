#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/file.h"
#include "core/base/finding.h"
#include "core/base/text.h"
#include "core/formats/file_rules.h"
#include "core/formats/phspd_text.h"
#include "core/motion/motion.h"
#include "core/quality/tracked_points.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/read_raw.h"
#include "ingest/sources/smpl_motion.h"

namespace mocurate {
namespace {

/// The joints of a recording of PHSPD from its first annotated frame to its last. Frames without an annotation, or
/// whose row is damaged, have confidence 0.
struct PhspdTracks {
  int first_frame = 0;             ///< its number in the recording
  JointPositions positions;        ///< (frames, 24) metres, axes of the file, in the order of the file (SMPL's)
  std::vector<double> confidence;  ///< (frames*24); 0: missing
  std::vector<Finding> findings;   ///< of damaged rows, and "time_gap" of frames without a row
};

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

/// Errors of ParsePhspdPose; kInconsistent where no frame is left, or a gap is too long for a recording.
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

constexpr const char* kPoses = "pose.txt";
constexpr const char* kShapes = "shape_smpl.txt";

Expected<RawFile> ShapesIn(const FileBytes& file) {
  const Expected<PhspdShape> shape = ParsePhspdShape(file.bytes, file.name);
  if (!shape) return Forward(shape);
  return RawFile::Of({file.name, "phspd_shape", {}, {{"frames", static_cast<double>(shape->frame.size())}}});
}

Expected<RawFile> PosesIn(const FileBytes& file) {
  Expected<PhspdTracks> tracks = ReadPhspdTracks(file.bytes, file.name, file.damaged_rows);
  if (!tracks) return Forward(tracks);
  RawClip clip;
  clip.format = "phspd_pose";
  clip.frames = tracks->positions.frames;
  clip.joints = kPhspdJoints;
  clip.layout_evidence = "rows of 73 numbers, the frame and 24 joints of x, y, z: frames " +
                         std::to_string(tracks->first_frame) + " to " +
                         std::to_string(tracks->first_frame + clip.frames - 1);
  clip.units = "m";
  clip.positions = std::move(tracks->positions);
  clip.confidence = std::move(tracks->confidence);
  FollowFormat("smpl24", {std::begin(kSmplJointNames), std::end(kSmplJointNames)}, "24 joints of SMPL", clip);
  clip.AddRemarks(tracks->findings);
  clip.facts.emplace_back("first_frame", std::to_string(tracks->first_frame));
  return RawFile::Of(std::move(clip));
}

/// ".../subject03_group2_time4/pose.txt" or shape_smpl.txt.
bool IsOfPhspd(const FileBytes& file, FileKind kind) {
  const std::filesystem::path name = file.path.filename();
  return kind == FileKind::kNumbers && (name == kPoses || name == kShapes) &&
         ParsePhspdRecording(DisplayPath(file.path.parent_path().filename())).has_value();
}

}  // namespace

FormatDriver PhspdFormat() {
  FormatDriver d;
  d.name = "phspd";
  d.inspected = "phspd_pose";
  d.ending = "pose.txt";
  d.gives = EvidenceKind::kJointTracks;
  d.unit = UnitOf::kMetres;
  d.sniff = IsOfPhspd;
  d.open = [](const FileBytes& file) { return file.path.filename() == kShapes ? ShapesIn(file) : PosesIn(file); };
  d.to_clip = TracksAsOpened;
  return d;
}

}  // namespace mocurate
